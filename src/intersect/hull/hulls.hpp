// The table of ways of computing the box around a solid, in any format.
#pragma once

#include <span>

#include "intersect/hull/list.hpp"
#include "number/format.hpp"
#include "shapes/hull.hpp"

namespace lostbits::intersect::hull {

struct HullWay {
    const HullInfo* info;
    /// Its numbers are of the format, as are those of the solid taken, which are rounded to it. Of a solid under a
    /// matrix it stands in the world, around the corners of the one in the space of the solid. Ask where `has_hull`.
    Hull<double> (*in)(const Format&, const Solid<double>&);
};

/// In the order of the list.
std::span<const HullWay> hulls();
/// The one that is taken where none is named: the exact box rounded outward.
const HullWay& usual_hull();

}  // namespace lostbits::intersect::hull
