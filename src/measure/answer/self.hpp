// What a formula says without rounding, as opposed to what its arithmetic makes of it: of a form, and of a call on a
// tape.
#pragma once

#include <optional>
#include <span>

#include "intersect/table/table.hpp"
#include "measure/truth/certified.hpp"
#include "number/ball.hpp"
#include "number/concept.hpp"
#include "number/real.hpp"

namespace lostbits::measure::answer {

/// The form evaluated exactly on inputs that are exact: by enclosures of rising precision up to `limit_bits`. Nothing
/// where the form misses, where its exact value is undefined (0/0 on a tangent), or where the limit is reached, which
/// happens only where an irrational intermediate has to be compared with the value it equals.
std::optional<truth::Certified> without_rounding(const intersect::table::Intersector& form, const Ray<double>& ray,
                                                 const intersect::Target<double>& target, int limit_bits = 4096);

/// Of arguments that are enclosed; nothing where that leaves the decision or the number open. A ball of 2^880 or more
/// is infinite, as the end of a ray may be.
std::optional<Ball> without_rounding(const Call& call, std::span<const Ball> arguments);
/// To 2048 bits.
std::optional<BasicReal<2048>> without_rounding(const Call& call, std::span<const BasicReal<2048>> arguments);

}  // namespace lostbits::measure::answer
