// The cylinder: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/capped_span.hpp"
#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points no farther than `radius` > 0 from the line through `base` and `top`, and between the planes across this
/// line at the two points. The cylinder is closed, with caps.
template <class T>
struct Cylinder {
    Vec<T> base;
    Vec<T> top;
    T radius;

    static constexpr std::string_view name = "cylinder", plural = "cylinders";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a cylinder of radius 2 along the z axis, from -2 to 2",
                                      .touching_ray = "a ray along its side",
                                      .degenerate = "a radius of 0",
                                      .anchor_points = "ends of axes"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "base", .short_name = "b"},
         {.name = "top", .short_name = "t", .limit = Key::Limit::differs_from_previous},
         {.name = "radius", .short_name = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    static Cylinder around(const Vec<T>& p, const T& half) {
        return {{p.x, p.y, p.z - half}, {p.x, p.y, p.z + half}, half};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * base + (T(1) / T(2)) * top; }
    /// Returns half of its height or its radius, whichever is larger.
    [[nodiscard]] T half_extent() const { return max(radius, length(axis()) / T(2)); }
    [[nodiscard]] Sphere<T> ball_around() const { return {middle(), sqrt(square(radius) + square(axis()) / T(4))}; }
    /// Returns the point of the cylinder at the fraction u.x of its height, and at the fractions u.y and u.z of its
    /// width.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const PerpendicularAxes<T> axes(axis());
        return base + u.x * axis() + ((2 * u.y - 1) * radius) * axes.first + ((2 * u.z - 1) * radius) * axes.second;
    }
    /// Returns the cylinder scaled by `factor`. Its surface point nearest to `viewpoint` does not move. Returns nothing
    /// if there is no single nearest point.
    [[nodiscard]] std::optional<Cylinder> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        if (length(perpendicular_to_axis(viewpoint)) == 0) return std::nullopt;
        const Vec<T> nearest_point = project_onto_surface(viewpoint);
        return Cylinder{nearest_point + factor * (base - nearest_point), nearest_point + factor * (top - nearest_point),
                        factor * radius};
    }

    /// With v = top − base, f = o − base, m = v × f and n = v × d, the side is |m + t n|² ≤ r²|v|²: h = m·n, c = m² −
    /// r²v², a = n², q = v²(r² n² − (f·n)²), because m × n = v (f·n) up to the sign. The caps are 0 ≤ v·f + t v·d ≤ v².
    /// Roots and caps are compared by dyadic polynomials of degree eight. For doubles, an interval of 8 (1024 + 1074) +
    /// 16 < 16900 bits decides each.
    [[nodiscard]] CappedSpan<T> span(const Ray<T>& ray) const {
        const Vec<T>& d = ray.direction;
        const Vec<T> v = axis(), f = ray.origin - base, m = cross(v, f), n = cross(v, d);
        const T v2 = square(v), r2 = square(radius), a = square(n);
        return make_capped_span<T>({dot(m, n), square(m) - r2 * v2, a, v2 * (r2 * a - square(dot(f, n))), square(d)},
                                   dot(v, f), dot(v, d), v2);
    }
    /// Returns the signed distance of a point from the side or from the caps, whichever is larger, in units of
    /// `unit()`, positive outside.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const { return max(side_distance(p), cap_distance(p)) / radius; }
    [[nodiscard]] T unit() const { return radius; }
    /// Returns the signed distance of a point from the surface, negative inside: that of a rectangle in the plane of
    /// the axis and the point.
    [[nodiscard]] T distance(const Vec<T>& p) const {
        const T zero(0), x = side_distance(p), y = cap_distance(p), out_x = max(x, zero), out_y = max(y, zero);
        return sqrt(square(out_x) + square(out_y)) + min(max(x, y), zero);
    }
    /// Returns the outward unit normal at the point p of a ray: that of the side or of the cap, whichever is nearer to
    /// p.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> v = axis(), w = perpendicular_to_axis(p);
        const T axis_position = dot(v, Vec<T>(p - middle())), w_factor = T(1) / length(w), size = T(1) / length(v);
        const auto is_cap = cap_distance(p) > side_distance(p);
        const T v_factor = select(axis_position < T(0), -size, size);
        const auto component = [&](const T& w_component, const T& v_component) {
            return select(is_cap, v_component * v_factor, w_component * w_factor);
        };
        return {component(w.x, v.x), component(w.y, v.y), component(w.z, v.z)};
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_surface(p); }
    /// Returns the projected point with its error bound. The position along the axis is off by γ(8)|p − base|/|v|,
    /// which only moves the point along the surface. The vector across the axis, the foot of the perpendicular and the
    /// sum add about ten more roundings of no more than |p − base| + r.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - base)) + radius;
        BoundedPoint<T> bounded{project_onto_surface(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(16) * size + gamma_bound<T>(3) * abs(base[i]);
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> axis() const { return top - base; }
    /// Returns the vector from the axis to p, perpendicular to the axis.
    [[nodiscard]] Vec<T> perpendicular_to_axis(const Vec<T>& p) const {
        const Vec<T> v = axis(), f = p - base;
        return f - (dot(v, f) / square(v)) * v;
    }
    [[nodiscard]] T side_distance(const Vec<T>& p) const {
        return length(cross(axis(), Vec<T>(p - base))) / length(axis()) - radius;
    }
    [[nodiscard]] T cap_distance(const Vec<T>& p) const {
        const Vec<T> v = axis();
        return max(-dot(v, Vec<T>(p - base)), dot(v, Vec<T>(p - top))) / length(v);
    }
    /// Moves a point to the surface. The coordinates are the distance from the axis and the position along it. Outside,
    /// each coordinate beyond its limit is moved to the limit. Inside, the coordinate nearer to its limit is moved to
    /// it.
    [[nodiscard]] Vec<T> project_onto_surface(const Vec<T>& p) const {
        const T zero(0), one(1), x = side_distance(p), y = cap_distance(p);
        const Vec<T> v = axis(), w = perpendicular_to_axis(p);
        const T axis_fraction = dot(v, Vec<T>(p - base)) / square(v), size = length(w);
        const auto moves_to_side = x > zero || (x >= y && y <= zero), moves_to_cap = y > zero || (y > x && x <= zero);
        const T k = select(moves_to_side, radius / size, one);
        const T nearest_end = select(axis_fraction + axis_fraction < one, zero, one),
                new_fraction = select(moves_to_cap, nearest_end, axis_fraction);
        return base + new_fraction * v + k * w;
    }
};

}  // namespace lostbits
