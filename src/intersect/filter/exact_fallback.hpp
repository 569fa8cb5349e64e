// Decides a single ray that a filter leaves undecided: in wider arithmetic, and at last without rounding. One function
// serves all formats and the lanes of packs, so it is compiled once.
#pragma once

#include "intersect/deciding_arithmetic.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::filter {

struct FallbackAnswer {
    bool hit;
    double t;                       ///< −1 for a miss
    DecidingArithmetic arithmetic;  ///< the arithmetic that proved the answer
};

/// Decides whether a ray hits a primitive, and where. The shape must have a form that filters by its span
/// (by_span.hpp). `numbers` holds the origin and direction of the ray, then the numbers of the primitive in the order
/// of its keys. `unit_roundoff` (u) is that of the format to which the caller rounds t once more. The decision is
/// right. The error of t is at most 15 u t, or at most the smallest subnormal number of double. If a number is not
/// finite, or the direction is zero, the answer is a miss.
///
/// Computes in double if u is larger than that of double, then in double-double (`Ball`), then in intervals
/// (`Interval`) of 192 bits. Doubles the number of bits until the intervals decide. The decisions are signs of
/// polynomials of the inputs, which enough bits hold exactly (`FallbackLimits` says how many for each span).
FallbackAnswer exact_fallback(Shape shape, const double* numbers, double unit_roundoff);

}  // namespace lostbits::intersect::filter
