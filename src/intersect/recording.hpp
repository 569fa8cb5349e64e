// What the inputs on a form's tape are called.
#pragma once

#include <string>
#include <vector>

#include "intersect/table.hpp"

namespace lostbits {

/// In the order in which `Intersector::record` takes them: `o.x` … `d.z`, the solids' numbers (`centre.x`, `radius`, `lo.x`; `s1.centre.x`
/// where there are several), then the ray's end `tmax` of a form of boxes, or the constants of a march.
std::vector<std::string> input_names(const Intersector& form, const Target<double>& target);

}  // namespace lostbits
