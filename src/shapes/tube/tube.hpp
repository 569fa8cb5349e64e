// The tube: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "geometry/wall_span.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits {

/// A cylinder without caps, open at both ends: all points at `radius` > 0 from the line through `bottom` and `top`,
/// between the planes across this line at the two points. It is a surface, and a ray may hit it from both sides. A line
/// along the axis misses it, even if it lies in the wall.
template <class T>
struct Tube {
    Vec<T> bottom;
    Vec<T> top;
    T radius;

    static constexpr std::string_view name = "tube", plural = "tubes";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a tube of radius 2 along the x axis, from -2 to 2",
                                      .touching_ray = "a ray through an open end's rim",
                                      .degenerate = "a radius of 0",
                                      .anchor_points = "ends of axes"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "bottom", .short_name = "lo"},
         {.name = "top", .short_name = "t", .limit = Key::Limit::differs_from_previous},
         {.name = "radius", .short_name = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// Builds a tube along x. Tests of a shape's plainest primitive use rays along z, and such a ray meets its wall.
    static Tube around(const Vec<T>& p, const T& half) {
        return {{p.x - half, p.y, p.z}, {p.x + half, p.y, p.z}, half};
    }

    [[nodiscard]] Vec<T> middle() const { return capped_cylinder().middle(); }
    [[nodiscard]] T half_extent() const { return capped_cylinder().half_extent(); }
    [[nodiscard]] Sphere<T> ball_around() const { return capped_cylinder().ball_around(); }
    /// Returns the point of the wall at the fraction u.x of its height, in the direction of u.y and u.z across the
    /// axis.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const PerpendicularAxes<T> axes(axis());
        const T x = 2 * u.y - 1, y = 2 * u.z - 1, size = sqrt(square(x) + square(y));
        if (size == 0) return bottom + u.x * axis() + radius * axes.first;
        return bottom + u.x * axis() + (radius * x / size) * axes.first + (radius * y / size) * axes.second;
    }
    [[nodiscard]] std::optional<Tube> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        if (length(perpendicular_to_axis(viewpoint)) == 0) return std::nullopt;
        const Vec<T> nearest_point = project_onto_surface(viewpoint);
        return Tube{nearest_point + factor * (bottom - nearest_point), nearest_point + factor * (top - nearest_point),
                    factor * radius};
    }

    /// Returns the t at which the line crosses the wall, from the span of the cylinder.
    [[nodiscard]] WallSpan<T> span(const Ray<T>& ray) const {
        const CappedSpan<T> span = capped_cylinder().span(ray);
        return {span, span.d2};
    }
    /// Returns the distance of a point from the wall, in units of `unit()`; it is positive inside the tube too.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const { return distance(p) / radius; }
    [[nodiscard]] T unit() const { return radius; }
    /// Returns |p − q| with q the point of the wall nearest to p. A tube has no inside, so this is never negative.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - project_onto_surface(p))); }
    /// Returns the unit normal on the side that the ray comes from.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>& p) const {
        const Vec<T> w = perpendicular_to_axis(p);
        const T k = T(1) / length(w), signed_k = select(dot(w, ray.direction) > T(0), -k, k);
        return {signed_k * w.x, signed_k * w.y, signed_k * w.z};
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_surface(p); }
    /// Returns the projected point with its error bound, which is that of the cylinder.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - bottom)) + radius;
        BoundedPoint<T> bounded{project_onto_surface(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(16) * size + gamma_bound<T>(3) * abs(bottom[i]);
        return bounded;
    }

private:
    [[nodiscard]] Cylinder<T> capped_cylinder() const { return {bottom, top, radius}; }
    [[nodiscard]] Vec<T> axis() const { return top - bottom; }
    /// Returns the position of a point along the axis, as a fraction of its length.
    [[nodiscard]] T axis_fraction(const Vec<T>& p) const { return dot(axis(), Vec<T>(p - bottom)) / square(axis()); }
    [[nodiscard]] Vec<T> perpendicular_to_axis(const Vec<T>& p) const { return p - bottom - axis_fraction(p) * axis(); }
    [[nodiscard]] Vec<T> project_onto_surface(const Vec<T>& p) const {
        const Vec<T> w = perpendicular_to_axis(p);
        return bottom + min(max(axis_fraction(p), T(0)), T(1)) * axis() + (radius / length(w)) * w;
    }
};

}  // namespace lostbits
