// The cone: its numbers, its exact span on a ray, and its distances.
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

/// All points between the planes across the axis at `base` and `top` that are no farther from the axis than a radius
/// which changes linearly from `base_radius` > 0 to `top_radius` ≥ 0. The cone is closed, with caps. If the top radius
/// is 0, the top is an apex.
template <class T>
struct Cone {
    Vec<T> base;
    Vec<T> top;
    T base_radius;
    T top_radius;

    static constexpr std::string_view name = "cone", plural = "cones";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a cone along the z axis, from radius 2 at -2 to radius 1 at 2",
                                      .touching_ray = "a ray along its side",
                                      .degenerate = "a radius of 0 at the base",
                                      .anchor_points = "ends of axes"};
    static constexpr std::array<Key, 4> keys{
        {{.name = "base", .short_name = "b"},
         {.name = "top", .short_name = "t", .limit = Key::Limit::differs_from_previous},
         {.name = "base_radius", .short_name = "rb", .kind = Key::Kind::length, .limit = Key::Limit::positive},
         {.name = "top_radius", .short_name = "rt", .kind = Key::Kind::length, .limit = Key::Limit::not_negative}}};

    static Cone around(const Vec<T>& p, const T& half) {
        return {{p.x, p.y, p.z - half}, {p.x, p.y, p.z + half}, half, half / T(2)};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * base + (T(1) / T(2)) * top; }
    /// Returns half of its height or its larger radius, whichever is larger.
    [[nodiscard]] T half_extent() const { return max(unit(), length(axis()) / T(2)); }
    [[nodiscard]] Sphere<T> ball_around() const { return {middle(), sqrt(square(unit()) + square(axis()) / T(4))}; }
    /// Returns the point of the cone at the fraction u.x of its height, and at the fractions u.y and u.z of its width
    /// there.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const PerpendicularAxes<T> axes(axis());
        const T r = base_radius + u.x * (top_radius - base_radius);
        return base + u.x * axis() + ((2 * u.y - 1) * r) * axes.first + ((2 * u.z - 1) * r) * axes.second;
    }
    /// Returns the cone scaled by `factor`. Its surface point nearest to `viewpoint` does not move. Returns nothing if
    /// there is no single nearest point.
    [[nodiscard]] std::optional<Cone> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        if (length(perpendicular_to_axis(viewpoint)) == 0) return std::nullopt;
        const Vec<T> nearest_point = project_onto_surface(viewpoint);
        return Cone{nearest_point + factor * (base - nearest_point), nearest_point + factor * (top - nearest_point),
                    factor * base_radius, factor * top_radius};
    }

    /// Let v = top − base, f = o − base, s = top_radius − base_radius, m = v × f and n = v × d. The radius of the cone
    /// at the height of o, times v², is ρ = base_radius v² + s v·f. Along the ray it changes by σ = s v·d per unit of
    /// t. The point at t is in the cone if v² |m + t n|² ≤ (ρ + t σ)². So P(t) = a t² + 2 h t + c has
    ///     a = v² n² − σ²,  h = v² m·n − ρσ,  c = v² m² − ρ².
    /// Its discriminant q = h² − a c would cancel for an origin far away. With w = d × f it is computed without a
    /// square of the length of f, since ρn − σm = v² (base_radius n − s w) + s (v·w) v and
    ///     q = v² (|ρn − σm|² − v⁴ (v·w)²).
    /// Between the caps both radii are at least 0, so the cone is convex there. Every decision is the sign of a dyadic
    /// polynomial of degree twelve at most. For doubles, an interval of 12 (1024 + 1074) + 24 < 25300 bits decides
    /// each.
    [[nodiscard]] CappedSpan<T> span(const Ray<T>& ray) const {
        const Vec<T>& d = ray.direction;
        const Vec<T> v = axis(), f = ray.origin - base, m = cross(v, f), n = cross(v, d), w = cross(d, f);
        const T v2 = square(v), v_dot_f = dot(v, f), v_dot_d = dot(v, d), s = top_radius - base_radius, vw = dot(v, w);
        const T rho = base_radius * v2 + s * v_dot_f, sigma = s * v_dot_d;
        const Vec<T> k = v2 * (base_radius * n - s * w) + (s * vw) * v;
        return make_capped_span<T>({v2 * dot(m, n) - rho * sigma, v2 * square(m) - square(rho),
                                    v2 * square(n) - square(sigma), v2 * (square(k) - square(v2 * vw)), square(d)},
                                   v_dot_f, v_dot_d, v2);
    }
    /// Returns the signed distance of a point from the side or from the caps, whichever is larger, in units of
    /// `unit()`, positive outside.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        const AxialSection profile(*this, p);
        return max(profile.side_distance(), profile.cap_distance()) / unit();
    }
    /// Returns the larger radius.
    [[nodiscard]] T unit() const { return max(base_radius, top_radius); }
    /// Returns the signed distance of a point from the surface, negative inside.
    [[nodiscard]] T distance(const Vec<T>& p) const {
        const AxialSection profile(*this, p);
        const T signed_distance = max(profile.side_distance(), profile.cap_distance());
        return select(signed_distance <= T(0), signed_distance, profile.distance_to_nearest());
    }
    /// Returns the outward unit normal at the point p of a ray: that of the side or of the cap, whichever is nearer to
    /// p.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const AxialSection profile(*this, p);
        const Vec<T> v = axis(), w = perpendicular_to_axis(p);
        const auto is_cap = profile.cap_distance() > profile.side_distance();
        const T end_sign = select(profile.y + profile.y < profile.height, T(-1), T(1));
        const T axis_factor = select(is_cap, end_sign, profile.fall / profile.slant) / profile.height;
        const T radial_factor = select(is_cap, T(0), profile.height / profile.slant / length(w));
        return {axis_factor * v.x + radial_factor * w.x, axis_factor * v.y + radial_factor * w.y,
                axis_factor * v.z + radial_factor * w.z};
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_surface(p); }
    /// Returns the projected point with its error bound. The bound is that of the cylinder, with two more roundings of
    /// the position along the side. They move the point along the surface, except for the rounding of the radius there.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - base)) + unit();
        BoundedPoint<T> bounded{project_onto_surface(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(18) * size + gamma_bound<T>(3) * abs(base[i]);
        return bounded;
    }

private:
    /// A point and the cone in a plane through the axis: x is the distance from the axis, and y the position along the
    /// axis from the base.
    struct AxialSection {
        struct Point {
            T x, y;
        };
        T height, x, y, base_radius, top_radius;
        T fall;   ///< decrease of the radius from the base to the top
        T slant;  ///< length of the side

        AxialSection(const Cone& cone, const Vec<T>& p)
            : height(length(cone.axis())),
              x(length(cross(cone.axis(), Vec<T>(p - cone.base))) / height),
              y(dot(cone.axis(), Vec<T>(p - cone.base)) / height),
              base_radius(cone.base_radius),
              top_radius(cone.top_radius),
              fall(base_radius - top_radius),
              slant(sqrt(square(height) + square(fall))) {}
        [[nodiscard]] T side_distance() const { return ((x - base_radius) * height + y * fall) / slant; }
        [[nodiscard]] T cap_distance() const { return max(-y, y - height); }
        /// Returns the nearest point of the side.
        [[nodiscard]] Point on_side() const {
            const T position = (y * height - (x - base_radius) * fall) / square(slant),
                    fraction = min(max(position, T(0)), T(1));
            return {base_radius - fraction * fall, fraction * height};
        }
        [[nodiscard]] Point on_base() const { return {min(x, base_radius), T(0)}; }
        [[nodiscard]] Point on_top() const { return {min(x, top_radius), height}; }
        [[nodiscard]] T distance_to(const Point& q) const { return sqrt(square(x - q.x) + square(y - q.y)); }
        [[nodiscard]] Point nearest() const {
            const Point cap_point = nearer(on_base(), on_top());
            return nearer(on_side(), cap_point);
        }
        [[nodiscard]] T distance_to_nearest() const { return distance_to(nearest()); }

    private:
        [[nodiscard]] Point nearer(const Point& a, const Point& b) const {
            const auto a_is_nearer = distance_to(a) <= distance_to(b);
            return {select(a_is_nearer, a.x, b.x), select(a_is_nearer, a.y, b.y)};
        }
    };

    [[nodiscard]] Vec<T> axis() const { return top - base; }
    /// Returns the vector from the axis to p, perpendicular to the axis.
    [[nodiscard]] Vec<T> perpendicular_to_axis(const Vec<T>& p) const {
        const Vec<T> v = axis(), f = p - base;
        return f - (dot(v, f) / square(v)) * v;
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Vec<T>& p) const {
        const AxialSection profile(*this, p);
        const auto nearest_point = profile.nearest();
        const Vec<T> w = perpendicular_to_axis(p);
        return base + (nearest_point.y / profile.height) * axis() + (nearest_point.x / length(w)) * w;
    }
};

}  // namespace lostbits
