// Whether the problem or the formula is to blame.
#pragma once

#include "measure/truth/enclose_box.hpp"

namespace lostbits::measure::truth {

/// κ = Σ |xᵢ ∂t/∂xᵢ| / |t| of the true first intersection, over all inputs: origin, direction, the solid's numbers.
/// Relative errors of δ in each input alone move t by at most κ·δ in all, to first order. Good to 2^-20 of itself.
/// Infinite where t = 0, and on an exact tangent, where ∂t/∂xᵢ is; NaN for a miss.
double condition(const Ray<double>& ray, const Solid<double>& solid, intersect::Convention convention = {});
double condition(const Ray<Real>& ray, const Solid<Real>& solid, intersect::Convention convention = {});

/// The bits that half an ulp in each input alone would cost: the lost bits of the envelope max(½, κ/2) ulp.
double inherent_bits(double condition, int precision);

}  // namespace lostbits::measure::truth
