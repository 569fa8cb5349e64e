// The table of methods to compute the bounding box of a primitive, in any format.
#pragma once

#include <span>

#include "intersect/hull/list.hpp"
#include "number/format.hpp"
#include "shapes/hull.hpp"

namespace lostbits::intersect::hull {

struct HullWay {
    const HullInfo* info;
    /// Computes the box of a primitive whose numbers are first rounded to the format; the numbers of the box are of the
    /// format too. Under a matrix the box is in the world, around the corners of the one in the space of the primitive.
    /// Ask only if `has_hull`.
    Hull<double> (*in)(const Format&, const Solid<double>&);
};

/// In the order of the list.
std::span<const HullWay> hulls();
/// The method used if none is named: the exact box rounded outward.
const HullWay& usual_hull();

}  // namespace lostbits::intersect::hull
