// Sets of forms, one for each of several shapes, in the table of intersectors. They measure scenes with several shapes.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// Returns the reason why these forms cannot be a set, or an empty string if they can. A set has one form for each of
/// several shapes, and its forms have a format in common. The values of t are compared between primitives, so either
/// all forms yield t or none does.
std::string refusal_of_set(const std::vector<const Intersector*>& parts);

/// The form `sphere.unified+box.signs` of two or more forms of different shapes, in any order. Each function of the
/// form calls the same function of the form for the target's shape; it is null unless all forms have that function. If
/// one form takes unit directions, all forms receive unit directions, and every t is a distance. The truth of each
/// primitive follows the contract of its own form. Each form is created once and kept, as registered forms are. Throws
/// InputError if `refusal_of_set` returns a reason.
const Intersector& find_or_add_set(std::vector<const Intersector*> parts);

}  // namespace lostbits::intersect::table
