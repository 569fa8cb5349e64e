// Settles a single ray that a filter leaves open: in wider arithmetic, and at last without rounding. One function
// serves all formats and the lanes of packs, so it is compiled once.
#pragma once

#include "intersect/filter_arithmetic.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::filter {

struct FallbackAnswer {
    bool hit;
    double t;              ///< −1 for a miss
    FilterArithmetic way;  ///< the arithmetic that proved it
};

/// Settles a ray and a primitive of a shape whose form filters by its span. `numbers` holds the origin and direction of
/// the ray, then the numbers of the primitive in the order of its keys. The decision is right, and t is within 15 `u`
/// of itself (the caller rounds it once more to a format of this u), or within the smallest subnormal number of double.
/// If a number is not finite, or the direction is zero, the answer is a miss.
///
/// It computes in double if u is coarser, then in double-double (`Ball`), then in intervals (`Interval`) of 192 bits,
/// doubled until they decide. The decisions are signs of polynomials of the inputs, which enough bits hold exactly
/// (`Deciding` of each span says how many).
FallbackAnswer exact_fallback(Shape shape, const double* numbers, double u);

}  // namespace lostbits::intersect::filter
