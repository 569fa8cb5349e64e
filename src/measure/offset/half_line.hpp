// Decides how an exact half-line meets one primitive: signs of dyadic polynomials in stored numbers, each of them
// proved.
#pragma once

#include <limits>

#include "shapes/primitive.hpp"

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
    bool inside = false;   ///< q is an inner point of the primitive
    bool outside = false;  ///< q is not in the primitive; where neither holds, q lies on its surface
    bool meets = false;    ///< a point with t > from is an inner point of the primitive

    friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// Finds how a half-line meets a primitive. With f = q − G, c = f·f − r², h = f·w and aΔ = w·w r² − |f × w|²: q is
/// inside where c < 0, and the half-line meets inner points where c < 0, or h < 0 and aΔ > 0. A box compares q with its
/// planes, and uses the slabs of the open box. Double-double balls are tried first, then intervals of as many bits as
/// it takes: every polynomial is dyadic, so enough bits always decide. The half-line must be proper.
Meeting find_meeting(const HalfLine& line, const Primitive<double>& primitive);

/// Like `meets`, but for t < end alone: a point with from < t < end is an inner point of the primitive. A surface is
/// crossed there, but not at a rim.
bool meets_before(const HalfLine& line, double end, const Primitive<double>& primitive);

/// Far side of the primitive that a ray leaves, ahead of the point of its surface that is nearest to the origin of the
/// ray. Only a torus and a tube have one; infinite otherwise.
struct FarSide {
    double from = std::numeric_limits<double>::infinity();  ///< what is met at a larger t belongs to the far side
    double wall = std::numeric_limits<double>::infinity();  ///< where it is met, if it is

    friend bool operator==(const FarSide&, const FarSide&) = default;
};

/// Finds the far side. It begins where the polynomial of the surface turns along the ray: half of the way across a
/// tube, and farthest from the part of a torus that is left and from the part across the hole, whether or not the ray
/// meets that part. Computed in doubles: it separates a far wall from the surface that is left, and proves nothing.
FarSide far_side(const Ray<double>& leaving, const Primitive<double>& primitive);

/// True where a ray that has left the primitive may meet it again; false for convex and flat ones.
bool is_hit_again(const Primitive<double>& primitive);

/// True where the segment from a to b, ends included, meets inner points of the primitive. a and b must be finite.
bool passes_through(const Vec<double>& a, const Vec<double>& b, const Primitive<double>& primitive);

}  // namespace lostbits::measure::offset
