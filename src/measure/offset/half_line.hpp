// What an exact half-line does with one solid: signs of dyadic polynomials in stored numbers, each of them proved.
#pragma once

#include "shapes/solid.hpp"

namespace lostbits::measure::offset {

/// The points o + t·w with t > from: an origin, a direction and a t_min as a format stores them.
struct HalfLine {
    Ray<double> ray;
    double from = 0;

    /// Every number is finite, w is not zero, and from is not negative.
    [[nodiscard]] bool is_proper() const;
};

/// Of q = o + from·w, where the half-line starts, and of all of it.
struct Meeting {
    bool inside = false;   ///< q is an inner point of the solid
    bool outside = false;  ///< q is not in the solid; where neither holds, q lies on its surface
    bool meets = false;    ///< a point with t > from is an inner point of the solid

    friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// With f = q − G, c = f·f − r², h = f·w and aΔ = w·w r² − |f × w|²: inside where c < 0, and the half-line meets inner
/// points where c < 0, or h < 0 and aΔ > 0. Of a box: comparisons of q with its planes, and the slabs of the open box.
/// Double-double balls first, then intervals of as many bits as it takes: every polynomial is dyadic, so enough bits
/// always decide. The half-line is proper.
Meeting find_meeting(const HalfLine& line, const Solid<double>& solid);

/// The same of t < end alone: a point with from < t < end is an inner point of the solid; of a surface, it is crossed
/// there, but not at a rim.
bool meets_before(const HalfLine& line, double end, const Solid<double>& solid);

/// Where a ray meets the primitive that it leaves once more: the t of its next wall, from the point of the surface that
/// is nearest to its origin; infinite where there is none. Only a torus and a tube have one. In doubles: it tells a far
/// wall from the surface that is left, and proves nothing.
double next_wall(const Ray<double>& leaving, const Solid<double>& solid);

/// Whether a ray that has left the primitive may meet it again: not where it is convex or flat.
bool is_met_again(const Solid<double>& solid);

/// Whether the way from a to b, both ends with it, meets inner points of the solid. a and b are finite.
bool passes_through(const Vec<double>& a, const Vec<double>& b, const Solid<double>& solid);

}  // namespace lostbits::measure::offset
