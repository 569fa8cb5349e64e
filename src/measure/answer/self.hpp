// The form without rounding: what its formula says, as opposed to what its arithmetic makes of it.
#pragma once

#include <optional>

#include "intersect/table/table.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::answer {

/// The form evaluated exactly on inputs that are exact: by enclosures of rising precision up to `limit_bits`. Nothing
/// where the form misses, where its exact value is undefined (0/0 on a tangent), or where the limit is reached, which
/// happens only where an irrational intermediate has to be compared with the value it equals.
std::optional<truth::Certified> without_rounding(const intersect::table::Intersector& form, const Ray<double>& ray,
                                                 const intersect::Target<double>& target, int limit_bits = 4096);

}  // namespace lostbits::measure::answer
