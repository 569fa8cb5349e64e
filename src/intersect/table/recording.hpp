// Names of the inputs on a form's tape.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The names in the order in which `Intersector::record` takes the inputs: `o.x` … `d.z`, the numbers of the primitives
/// (`centre.x`, `radius`, `lo.x`; `s1.centre.x` if there are several), the constants of a march, and last the end of
/// the ray, `ray.tmax` (forms have a `tmax` of their own).
std::vector<std::string> input_names(const Intersector& form, const Target<double>& target);

}  // namespace lostbits::intersect::table
