// The torus: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points no farther than `minor_radius` > 0 from the circle of `major_radius` around `centre` across `axis`, which
/// may have any length. The minor radius is less than the major one, so the torus has a hole. Otherwise the surface
/// would intersect itself, and the polynomial would not be negative everywhere inside.
template <class T>
struct Torus {
    Vec<T> centre;
    Vec<T> axis;
    T major_radius;
    T minor_radius;

    static constexpr std::string_view name = "torus", plural = "tori";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a torus in the plane y = 0, of the radii 1.25 and 0.75",
                                      .touching_ray = "a ray along its top",
                                      .degenerate = "a minor radius of 0",
                                      .anchor_points = "centres"};
    static constexpr std::array<Key, 4> keys{
        {{.name = "centre", .short_name = "c", .aliases = {"center"}},
         {.name = "axis", .short_name = "a", .kind = Key::Kind::direction, .limit = Key::Limit::not_zero},
         {.name = "major_radius", .short_name = "rm", .kind = Key::Kind::length, .limit = Key::Limit::positive},
         {.name = "minor_radius",
          .short_name = "rn",
          .kind = Key::Kind::length,
          .limit = Key::Limit::positive_below_previous}}};

    /// Builds a torus with its axis along y. The rays at the plainest primitives run along z, and such a ray meets the
    /// torus four times.
    static Torus around(const Vec<T>& middle, const T& half_extent) {
        const T eighth = half_extent / T(8);
        return {middle, {T(0), T(1), T(0)}, T(5) * eighth, T(3) * eighth};
    }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    [[nodiscard]] T half_extent() const { return major_radius + minor_radius; }
    [[nodiscard]] Sphere<T> ball_around() const { return {centre, half_extent()}; }
    /// Returns the point of the ring's plane in the direction of u.x and u.y, at the fraction u.z of the width of the
    /// ring.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const PerpendicularAxes<T> axes(axis);
        const T x = 2 * u.x - 1, y = 2 * u.y - 1, size = sqrt(square(x) + square(y));
        const T axis_distance = major_radius + (2 * u.z - 1) * minor_radius;
        if (size == 0) return centre + axis_distance * axes.first;
        return centre + (axis_distance * x / size) * axes.first + (axis_distance * y / size) * axes.second;
    }
    /// Returns the torus scaled by `factor`. Its surface point nearest to `viewpoint` does not move. Returns nothing if
    /// there is no single nearest point.
    [[nodiscard]] std::optional<Torus> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        const RelativeToCircle relative(*this, viewpoint);
        if (length(relative.across_axis) == 0 || relative.circle_distance == 0) return std::nullopt;
        const Vec<T> nearest_point = project_onto_surface(viewpoint);
        return Torus{nearest_point + factor * (centre - nearest_point), axis, factor * major_radius,
                     factor * minor_radius};
    }

    /// With f = o − centre, n the axis, w = f × d, a = d·d and x = a t + d·f, the vector from the centre to a point of
    /// the line is p = (g + x d)/a, where g = d × w is across d. So p² = (w² + x²)/a. With R and r the radii, (p² + R²
    /// − r²)² n² ≤ 4 R² |n × p|² becomes
    ///     n² (x² + e)² − 4 R² |n × g + x n × d|² ≤ 0,   e = a (R² − r²) + w²,
    /// a quartic without a cubic term. Only w and g in it are of the size of f. On the line x² ≤ a (R + r)². The sign
    /// of the discriminant says whether a root is double; it is a dyadic polynomial of degree 34. The names of the
    /// constants below are these letters: `n_cross_g` is n × g, `n2` is n².
    [[nodiscard]] QuarticSpan<T> span(const Ray<T>& ray) const {
        const Vec<T>& d = ray.direction;
        const Vec<T> f = ray.origin - centre, w = cross(f, d);
        const Vec<T> n_cross_g = cross(axis, cross(d, w)), n_cross_d = cross(axis, d);
        const T a = square(d), n2 = square(axis), outer_radius = major_radius + minor_radius,
                four_r2 = square(T(2) * major_radius);
        const T e = a * (outer_radius * (major_radius - minor_radius)) + square(w);
        const T constant_term = n2 * square(e) - four_r2 * square(n_cross_g),
                linear_term = T(-2) * (four_r2 * dot(n_cross_g, n_cross_d)),
                square_term = T(2) * (n2 * e) - four_r2 * square(n_cross_d);
        return {.f = {{constant_term, linear_term, square_term, T(0), n2}, 4},
                .a = a,
                .b = dot(f, d),
                .bound = T(2) * (sqrt(a) * outer_radius),
                .d2 = a};
    }
    /// Returns the polynomial of `span` in t: n² (p² + R² − r²)² − 4 R² |n × p|² with p = f + t d, since x = a t + d·f
    /// and |n × p|² = n² p² − (n·p)². It is computed by + − × alone, so number types without roots and quotients can be
    /// used. The names of the constants below are the letters of that formula: `n_f` is n·f, `n2` is n².
    [[nodiscard]] Polynomial<T> polynomial_along(const Ray<T>& ray) const {
        const auto dot_product = [](const Vec<T>& u, const Vec<T>& v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
        const Vec<T>&o = ray.origin, &d = ray.direction;
        const Vec<T> f(o.x - centre.x, o.y - centre.y, o.z - centre.z);
        const T n2 = dot_product(axis, axis), n_f = dot_product(axis, f), n_d = dot_product(axis, d),
                f2 = dot_product(f, f), f_d = dot_product(f, d), d2 = dot_product(d, d);
        const T sum_at_origin = f2 + (major_radius + minor_radius) * (major_radius - minor_radius);  // p² + R² − r²
        const T four_r2 = T(4) * (major_radius * major_radius);
        const T n2_sum = n2 * sum_at_origin, n2_f_d = n2 * f_d, n2_d2 = n2 * d2;
        return {{n2_sum * sum_at_origin - four_r2 * (n2 * f2 - n_f * n_f),
                 T(4) * (n2_sum * f_d) - T(2) * (four_r2 * (n2_f_d - n_f * n_d)),
                 T(4) * (n2_f_d * f_d) + T(2) * (n2_d2 * sum_at_origin) - four_r2 * (n2_d2 - n_d * n_d),
                 T(4) * (n2_f_d * d2), n2_d2 * d2},
                4};
    }
    /// Returns the signed distance of a point from the surface, in units of `unit()`, positive outside.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const { return distance(p) / minor_radius; }
    [[nodiscard]] T unit() const { return minor_radius; }
    /// Returns the signed distance of a point from the surface, negative inside.
    [[nodiscard]] T distance(const Vec<T>& p) const {
        return RelativeToCircle(*this, p).circle_distance - minor_radius;
    }
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const RelativeToCircle relative(*this, p);
        const T scale = T(1) / relative.circle_distance;
        return {scale * relative.from_circle.x, scale * relative.from_circle.y, scale * relative.from_circle.z};
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_surface(p); }
    /// Returns the projected point q + v (r/|v|) with its error bound. With c the centre, w is the part of f = p − c
    /// across the axis, off by γ(11)|f| at most, q = c + w (R/|w|) and v = p − q. The error of q is that of w times
    /// R/|w|, and γ(6)R more. An error in the direction of v turns the point about q, which keeps it on the surface;
    /// the error in the length of v(r/|v|) moves it by γ(6)r at most.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const RelativeToCircle relative(*this, p);
        const T position_error =
            gamma_bound<T>(12) * (major_radius * (length(Vec<T>(p - centre)) / length(relative.across_axis)));
        BoundedPoint<T> bounded{project_onto_surface(p), p};
        for (int i = 0; i < 3; ++i)
            bounded.delta[i] = position_error + gamma_bound<T>(8) * half_extent() + gamma_bound<T>(3) * abs(centre[i]);
        return bounded;
    }

private:
    /// Position of a point relative to the circle: `across_axis` is the part of its vector from the centre that is
    /// perpendicular to the axis, `from_circle` the vector from the nearest point of the circle, and `circle_distance`
    /// the length of the latter.
    struct RelativeToCircle {
        Vec<T> across_axis, from_circle;
        T circle_distance;

        RelativeToCircle(const Torus& torus, const Vec<T>& p)
            : across_axis(part_across_axis(torus, p)),
              from_circle(p - torus.centre - (torus.major_radius / length(across_axis)) * across_axis),
              circle_distance(length(from_circle)) {}

    private:
        static Vec<T> part_across_axis(const Torus& torus, const Vec<T>& p) {
            const Vec<T> from_centre = p - torus.centre;
            return from_centre - (dot(torus.axis, from_centre) / square(torus.axis)) * torus.axis;
        }
    };

    [[nodiscard]] Vec<T> project_onto_surface(const Vec<T>& p) const {
        const RelativeToCircle relative(*this, p);
        return centre + (major_radius / length(relative.across_axis)) * relative.across_axis +
               (minor_radius / relative.circle_distance) * relative.from_circle;
    }
};

}  // namespace lostbits
