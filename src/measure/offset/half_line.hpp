// Decides how an exact half-line meets one primitive: signs of dyadic polynomials in stored numbers, each of them
// proved.
#pragma once

#include "shapes/solid.hpp"

namespace lostbits::measure::offset {

/// The points o + t·w with t > from: an origin, a direction and a t_min as a format stores them.
struct HalfLine {
    Ray<double> ray;
    double from = 0;

    /// True where every number is finite, w is not zero, and from is not negative.
    [[nodiscard]] bool is_proper() const;
};

/// Position of the start q = o + from·w, and of the whole half-line.
struct Meeting {
    bool inside = false;   ///< q is an inner point of the solid
    bool outside = false;  ///< q is not in the solid; where neither holds, q lies on its surface
    bool meets = false;    ///< a point with t > from is an inner point of the solid

    friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// Finds how a half-line meets a primitive. With f = q − G, c = f·f − r², h = f·w and aΔ = w·w r² − |f × w|²: q is
/// inside where c < 0, and the half-line meets inner points where c < 0, or h < 0 and aΔ > 0. A box compares q with its
/// planes, and uses the slabs of the open box. Double-double balls are tried first, then intervals of as many bits as
/// it takes: every polynomial is dyadic, so enough bits always decide. The half-line must be proper.
Meeting find_meeting(const HalfLine& line, const Solid<double>& solid);

/// Like `meets`, but for t < end alone: a point with from < t < end is an inner point of the primitive. A surface is
/// crossed there, but not at a rim.
bool meets_before(const HalfLine& line, double end, const Solid<double>& solid);

/// The t at which a ray meets the primitive that it leaves once more (its next wall), from the point of the surface
/// that is nearest to its origin; infinite where there is none. Only a torus and a tube have one. Computed in doubles:
/// it separates a far wall from the surface that is left, and proves nothing.
double next_wall(const Ray<double>& leaving, const Solid<double>& solid);

/// True where a ray that has left the primitive may meet it again; false for convex and flat ones.
bool is_met_again(const Solid<double>& solid);

/// True where the segment from a to b, ends included, meets inner points of the primitive. a and b must be finite.
bool passes_through(const Vec<double>& a, const Vec<double>& b, const Solid<double>& solid);

}  // namespace lostbits::measure::offset
