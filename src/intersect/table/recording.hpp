// Names of the inputs on a form's tape.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// In the order in which `Intersector::record` takes them: `o.x` … `d.z`, the solids' numbers (`centre.x`, `radius`,
/// `lo.x`; `s1.centre.x` where there are several), the constants of a march, and last where the ray ends, `ray.tmax`
/// (forms have a `tmax` of their own).
std::vector<std::string> input_names(const Intersector& form, const Target<double>& target);

}  // namespace lostbits::intersect::table
