// Sets of forms, one for each of several shapes, as rows of the table. Scenes with several shapes are measured by them.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The reason why these forms cannot be a set; empty if they can. A set has one form for each of several shapes, with a
/// format in common. t is compared between primitives, so all forms yield it or none does.
std::string refusal_of_set(const std::vector<const Intersector*>& parts);

/// The row `sphere.unified+box.signs` of two or more forms of different shapes, in any order. Each function of the row
/// calls the same function of the form for the target's shape. A function is null unless all forms have it. If one form
/// takes unit directions, all get those, and every t is a distance. The truth of each primitive is by the contract of
/// its own form. The row is made once and kept, as enrolled rows are. InputError if `refusal_of_set` has a reason.
const Intersector& set_of(std::vector<const Intersector*> parts);

}  // namespace lostbits::intersect::table
