// Sensitivity of t to relative errors of the inputs, to first order.
#pragma once

#include <vector>

#include "measure/truth/certified.hpp"
#include "measure/truth/enclose.hpp"
#include "number/real.hpp"

namespace lostbits::measure::truth {

/// κ = Σ |xᵢ ∂t/∂xᵢ| / |t| of the true first intersection, over all inputs: origin, direction, the primitive's numbers.
/// If each input has a relative error of at most δ, t moves by at most κ·δ (relative, to first order). κ is good to
/// 2^-20 of itself. It is infinite if t = 0, and on an exact tangent, where ∂t/∂xᵢ is infinite; NaN for a miss. The
/// range is not an input: if the answer is the tmin of a ray that begins inside, κ is 0.
double condition(const Ray<double>& ray, const Primitive<double>& primitive, intersect::Convention convention = {},
                 const Range<double>& range = {});
double condition(const Ray<Real>& ray, const Primitive<Real>& primitive, intersect::Convention convention = {},
                 const Range<double>& range = {});

/// ∂t/∂xᵢ of the same intersection, first by the inputs in this order and then by the numbers of a matrix. Each
/// derivative is good to 2^-40 of the largest one. Empty for a miss, for a hit at the beginning of the range, and on an
/// exact tangent.
std::vector<double> gradient(const Ray<double>& ray, const Primitive<double>& primitive,
                             intersect::Convention convention = {}, const Range<double>& range = {});

}  // namespace lostbits::measure::truth
