// What a filter leaves open: a ray by itself, in wider arithmetic and at last without rounding. One function for all
// formats and for the lanes of packs, so that it is compiled once.
#pragma once

#include "intersect/way.hpp"
#include "shapes/solid.hpp"

namespace lostbits::intersect::filter {

struct Beyond {
    bool hit;
    double t;  ///< −1 of a miss
    Way way;   ///< the arithmetic that proved it
};

/// Of a ray (`numbers`: its origin and direction, then the numbers of the solid in the order of its keys) and a solid
/// of a shape whose form filters by its span. The decision is right and t is good to 15 `u` of itself (the caller
/// rounds it once more to a format of this u), or to the least subnormal number of double. A number that is not finite,
/// or a direction of zero, meets nothing.
///
/// In double where u is coarser, then in double-double (`Ball`), then in intervals (`Interval`) of 192 bits and twice
/// as many until they tell. What decides are polynomials of the inputs, which enough bits hold exactly (`Deciding` of
/// each span says how many).
Beyond beyond(Shape shape, const double* numbers, double u);

}  // namespace lostbits::intersect::filter
