// Whether the problem or the formula is to blame.
#pragma once

#include "measure/truth/certified.hpp"
#include "measure/truth/enclose.hpp"

namespace lostbits::measure::truth {

/// κ = Σ |xᵢ ∂t/∂xᵢ| / |t| of the true first intersection, over all inputs: origin, direction, the solid's numbers.
/// Relative errors of δ in each input alone move t by at most κ·δ in all, to first order. Good to 2^-20 of itself.
/// Infinite where t = 0, and on an exact tangent, where ∂t/∂xᵢ is; NaN for a miss. The range is no input: where the
/// answer is the tmin of a ray that begins inside, κ is 0.
double condition(const Ray<double>& ray, const Solid<double>& solid, intersect::Convention convention = {},
                 const Range<double>& range = {});
double condition(const Ray<Real>& ray, const Solid<Real>& solid, intersect::Convention convention = {},
                 const Range<double>& range = {});

/// How far a relative error of 2^-precision in each input can move a root t of that condition, to first order: as far
/// as κ says, and of a sphere, whose t = p ± √q, no further than |Δp| + √|Δq|, since |√(q + Δq) − √q| ≤ √|Δq|. That is
/// finite where κ is not, on a tangent; and where t = 0 it is how far the surface is from the origin then: 0 inside,
/// where 0 is the answer. In units of t.
double reach(const Ray<double>& ray, const Solid<double>& solid, double t, double condition, int precision);
double reach(const Ray<Real>& ray, const Solid<Real>& solid, double t, double condition, int precision);

/// Lost bits beyond what half an ulp in each input would cost. Where that is all of them (`inherent_bits` is p), κ says
/// no more, and the error is held against `reach`: log2(|t − t*| / max(reach, ½ ulp)), from 0 to p.
double excess_bits(double t, const Certified& truth, const FloatFormat& format, double condition, double reach);

/// The bits that half an ulp in each input alone would cost: the lost bits of the envelope max(½, κ/2) ulp.
double inherent_bits(double condition, int precision);

}  // namespace lostbits::measure::truth
