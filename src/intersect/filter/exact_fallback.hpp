// Decides a single ray that a filter does not: in wider arithmetic, and at last without rounding. One function serves
// all formats and the lanes of packs, so it is compiled once.
#pragma once

#include "intersect/filter_arithmetic.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::filter {

struct FallbackAnswer {
    bool hit;
    double t;                     ///< −1 for a miss
    FilterArithmetic arithmetic;  ///< the arithmetic that proved the answer
};

/// Decides a ray and a primitive of a shape whose form filters by its span. `numbers` holds the origin and direction of
/// the ray, then the numbers of the primitive in the order of its keys. The decision is right. The error of t is at
/// most 15 `u` t (the caller rounds t once more, to a format of this u), or at most the smallest subnormal number of
/// double. If a number is not finite, or the direction is zero, the answer is a miss.
///
/// It computes in double if u is coarser than that of double, then in double-double (`Ball`), then in intervals
/// (`Interval`) of 192 bits. The number of bits is doubled until the intervals decide. The decisions are signs of
/// polynomials of the inputs, which enough bits hold exactly (`FallbackLimits` says how many for each span).
FallbackAnswer exact_fallback(Shape shape, const double* numbers, double u);

}  // namespace lostbits::intersect::filter
