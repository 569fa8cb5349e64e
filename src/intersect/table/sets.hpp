// Sets of forms, one for each of several shapes, as rows of the table: what a scene of several shapes is measured by.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The reason why these forms cannot be a set; empty if they can. A set has one form for each of several shapes, with a
/// format in common. t is compared between primitives, so all forms yield it or none does.
std::string refusal_of_set(const std::vector<const Intersector*>& parts);

/// The row `sphere.unified+box.signs` of two or more forms of different shapes, whose order does not matter. Each of
/// its functions asks the form for the shape of the target's solid; it exists where each of them has one. Where one of
/// them is for unit directions, all get those, and every t is a distance. Each solid's truth is by the words of its own
/// form. Made once and kept, as enrolled rows are. InputError where `refusal_of_set` has a reason.
const Intersector& set_of(std::vector<const Intersector*> parts);

}  // namespace lostbits::intersect::table
