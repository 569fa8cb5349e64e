// The capsule: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/joined_span.hpp"
#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points no farther than `radius` > 0 from the segment from `start` to `end`.
template <class T>
struct Capsule {
    Vec<T> start;
    Vec<T> end;
    T radius;

    static constexpr std::string_view name = "capsule", plural = "capsules";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a capsule of radius 1 along the z axis, from -2 to 2",
                                      .touching_ray = "a ray that touches",
                                      .degenerate = "a radius of 0",
                                      .anchor_points = "ends of axes"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "start", .short_name = "s"},
         {.name = "end", .short_name = "e", .limit = Key::Limit::differs_from_previous},
         {.name = "radius", .short_name = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// Builds a capsule along z. The ball at each end is a quarter of its length.
    static Capsule around(const Vec<T>& p, const T& half) {
        const T r = half / T(2);
        return {{p.x, p.y, p.z - r}, {p.x, p.y, p.z + r}, r};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * start + (T(1) / T(2)) * end; }
    /// Returns half of its length.
    [[nodiscard]] T half_extent() const { return radius + length(axis()) / T(2); }
    [[nodiscard]] Sphere<T> ball_around() const { return {middle(), half_extent()}; }
    /// Returns a point near the axis: the point at the fraction u.x of the axis, moved within a cube of side 2
    /// `radius`.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const T k = 2 * radius;
        return start + u.x * axis() + Vec<T>((u.x - T(1) / 2) * k, (u.y - T(1) / 2) * k, (u.z - T(1) / 2) * k);
    }
    /// Returns the capsule scaled by `factor`. Its surface point nearest to `viewpoint` does not move. Returns nothing
    /// if there is no single nearest point.
    [[nodiscard]] std::optional<Capsule> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        const Vec<T> w = viewpoint - nearest_on_axis(viewpoint);
        if (length(w) == 0) return std::nullopt;
        const Vec<T> nearest_point = project_onto_surface(viewpoint);
        return Capsule{nearest_point + factor * (start - nearest_point), nearest_point + factor * (end - nearest_point),
                       factor * radius};
    }

    /// The line crosses the planes at the two ends in some order, and enters the infinite cylinder of the side once. If
    /// it enters the cylinder before the first plane, it enters the capsule by the ball at the first end; between the
    /// planes, by the side; and beyond both, by the other ball. It leaves in the same way. A line parallel to the axis
    /// enters and leaves by the balls. A line parallel to the planes meets the side if it is between them, and the ball
    /// at an end if it is beyond that end. The side is that of the cylinder: with v = end − start, f = o − start, m = v
    /// × f and n = v × d, h = m·n, c = m² − r²v², a = n², q = v²(r²n² − (f·n)²).
    [[nodiscard]] JoinedSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), one(1);
        const Vec<T>& d = ray.direction;
        const Vec<T> v = axis(), f = ray.origin - start, m = cross(v, f), n = cross(v, d);
        const T v2 = square(v), r2 = square(radius), a = square(n), v_dot_f = dot(v, f), v_dot_d = dot(v, d),
                d2 = square(d);

        // The quadratics of the side and of the balls.
        const QuadraticSpan<T> side{dot(m, n), square(m) - r2 * v2, a, v2 * (r2 * a - square(dot(f, n))), d2};
        const QuadraticSpan<T> at_start = Sphere<T>{start, radius}.span(ray), at_end = Sphere<T>{end, radius}.span(ray);

        // The planes, in the order in which the line crosses them; at infinity for a line parallel to them.
        const auto is_upward = v_dot_d > zero, is_parallel = !(is_upward || v_dot_d < zero),
                   is_below = v_dot_f<zero, is_above = v_dot_f> v2;
        const T magnitude = select(is_upward, v_dot_d, -v_dot_d);
        const Fraction<T> minus_infinity{-one, zero}, plus_infinity{one, zero};
        const Fraction<T> first_if_parallel = select(is_below, plus_infinity, minus_infinity),
                          last_if_parallel = select(is_above, minus_infinity, plus_infinity);
        const Fraction<T> first_plane_t =
            select(is_parallel, first_if_parallel,
                   select(is_upward, Fraction<T>{-v_dot_f, magnitude}, Fraction<T>{v_dot_f - v2, magnitude}));
        const Fraction<T> last_plane_t =
            select(is_parallel, last_if_parallel,
                   select(is_upward, Fraction<T>{v2 - v_dot_f, magnitude}, Fraction<T>{v_dot_f, magnitude}));

        // The parts of the surface where the line enters and leaves.
        const QuadraticSpan<T> first_ball = select(is_upward || (is_parallel && !is_above), at_start, at_end);
        const QuadraticSpan<T> last_ball = select(is_upward || (is_parallel && !is_below), at_end, at_start);
        const auto is_along_axis = a <= zero,
                   enters_before_first = quadratic_at(side, first_plane_t).order_of_near_root().less;
        const auto enters_before_last = quadratic_at(side, last_plane_t).order_of_near_root().at_most;
        const auto leaves_before_first = quadratic_at(side, first_plane_t).order_of_far_root().less;
        const auto leaves_before_last = quadratic_at(side, last_plane_t).order_of_far_root().at_most;
        return {.enter = select(is_along_axis || enters_before_first, first_ball,
                                select(enters_before_last, side, last_ball)),
                .leave = select(is_along_axis || !leaves_before_last, last_ball,
                                select(leaves_before_first, first_ball, side)),
                .d2 = d2};
    }
    /// Returns the signed distance of a point from the surface, in units of `unit()`, positive outside.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const { return distance(p) / radius; }
    [[nodiscard]] T unit() const { return radius; }
    /// Returns the signed distance of a point from the surface, negative inside: |p − q| − r with q the point of the
    /// axis nearest to p.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - nearest_on_axis(p))) - radius; }
    /// Returns the outward unit normal at the point p of a ray: away from the axis.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> w = p - nearest_on_axis(p);
        const T k = T(1) / length(w);
        return {k * w.x, k * w.y, k * w.z};
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_surface(p); }
    /// Returns the projected point with its error bound, which is that of the cylinder.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - start)) + radius;
        BoundedPoint<T> bounded{project_onto_surface(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(16) * size + gamma_bound<T>(3) * abs(start[i]);
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> axis() const { return end - start; }
    [[nodiscard]] Vec<T> nearest_on_axis(const Vec<T>& p) const {
        const Vec<T> v = axis();
        return start + min(max(dot(v, Vec<T>(p - start)) / square(v), T(0)), T(1)) * v;
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Vec<T>& p) const {
        const Vec<T> q = nearest_on_axis(p), w = p - q;
        return q + (radius / length(w)) * w;
    }
};

}  // namespace lostbits
