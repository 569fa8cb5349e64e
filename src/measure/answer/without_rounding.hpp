// Evaluates a form, or a call on a tape, without rounding, which separates the error of the formula from the error of
// its arithmetic.
#pragma once

#include <optional>
#include <span>

#include "intersect/table/table.hpp"
#include "measure/truth/certified.hpp"
#include "number/ball.hpp"
#include "number/concept.hpp"
#include "number/real.hpp"

namespace lostbits::measure::answer {

/// Evaluates the form exactly on inputs that are exact, by enclosures of rising precision up to `limit_bits`. Returns
/// nothing if the form misses, if its exact value is undefined (0/0 on a tangent), or if the limit is reached. The last
/// happens only where an irrational intermediate has to be compared with a value that it equals.
std::optional<truth::CertifiedNumber> evaluate_exactly(const intersect::table::Intersector& form,
                                                       const Ray<double>& ray, const intersect::Target<double>& target,
                                                       int limit_bits = 4096);

/// Evaluates a call on enclosed arguments. Returns nothing if the enclosures leave the decision or the result open. A
/// ball of 2^880 or more is infinite, as the end of a ray may be.
std::optional<Ball> evaluate_exactly(const Call& call, std::span<const Ball> arguments);
/// Evaluates a call to 2048 bits.
std::optional<BasicReal<2048>> evaluate_exactly(const Call& call, std::span<const BasicReal<2048>> arguments);

}  // namespace lostbits::measure::answer
