// Decides how an exact half-line meets one primitive. Each decision is the proved sign of a dyadic polynomial in stored
// numbers.
#pragma once

#include <limits>

#include "shapes/primitive.hpp"

namespace lostbits::measure::offset {

/// The points o + t·w with t > tmin: an origin, a direction and a tmin as a format stores them.
struct HalfLine {
    Ray<double> ray;
    double tmin = 0;

    /// True if every number is finite, w is not zero, and `tmin` is not negative.
    [[nodiscard]] bool is_proper() const;
};

/// Position of a half-line and its start q = o + tmin·w relative to a primitive.
struct Meeting {
    bool inside = false;   ///< q is an inner point of the primitive
    bool outside = false;  ///< q is not in the primitive; if `inside` is false too, q lies on its surface
    bool meets = false;    ///< a point with t > tmin is an inner point of the primitive

    friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// Finds how a half-line meets a primitive. For a sphere with centre G and radius r, let f = q − G, c = f·f − r², h =
/// f·w and aΔ = w·w r² − |f × w|². Then q is inside if c < 0, and the half-line meets inner points if c < 0, or if h <
/// 0 and aΔ > 0. For a box, q is compared with the planes, and the slabs of the open box are used. Numbers with a
/// running error bound are tried first, then intervals with more and more bits. Every polynomial is dyadic, so enough
/// bits always decide. The half-line must be proper.
Meeting find_meeting(const HalfLine& line, const Primitive<double>& primitive);

/// Like `Meeting::meets`, but only for t < end: true if a point with tmin < t < end is an inner point of the primitive.
/// For a surface, true if the half-line crosses it at such a t, and not at a rim.
bool meets_before(const HalfLine& line, double end, const Primitive<double>& primitive);

/// Far side of the primitive that a ray leaves: the part of its surface that the ray may meet again ahead. For a ray
/// that goes away from the primitive, only a torus and a tube have one; for other shapes both numbers are infinite. A
/// ray that goes into a primitive has one where it comes out (`FarSides` in at_point.cpp).
struct FarSide {
    double t_begin = std::numeric_limits<double>::infinity();  ///< the far side is everything at a larger t
    double t_wall = std::numeric_limits<double>::infinity();   ///< t at which the ray meets the far side, if it does

    friend bool operator==(const FarSide&, const FarSide&) = default;
};

/// Finds the far side of a torus or a tube ahead of the point of the surface that is nearest to the origin of the ray.
/// The far side begins where the polynomial of the surface has a turning point along the ray. In a tube this is half of
/// the way across. In a torus it is between the part that the ray leaves and the part across the hole, whether or not
/// the ray meets the latter. The result is computed in doubles and proves nothing: it only separates a far wall from
/// the surface that the ray leaves.
FarSide find_far_side(const Ray<double>& ray, const Primitive<double>& primitive);

/// True if a ray that has left the primitive may meet it again; false for convex and flat primitives.
bool is_hit_again(const Primitive<double>& primitive);

/// True if the segment from a to b, ends included, meets inner points of the primitive. a and b must be finite.
bool passes_through(const Vec<double>& a, const Vec<double>& b, const Primitive<double>& primitive);

}  // namespace lostbits::measure::offset
