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
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_unit = true, round = false,
                          edges = false;
    static constexpr ShapeTexts texts{.plainest = "a capsule of radius 1 along the z axis, from -2 to 2",
                                      .touching = "a ray that touches",
                                      .point = "a radius of 0",
                                      .places = "ends of axes"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "start", .letter = "s"},
         {.name = "end", .letter = "e", .limit = Key::Limit::differs_from_previous},
         {.name = "radius", .letter = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

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
    /// Returns the capsule scaled by k so that its surface point nearest to `fixed` does not move. Returns nothing if
    /// there is no single nearest point.
    [[nodiscard]] std::optional<Capsule> grown(const Vec<T>& fixed, const T& k) const {
        const Vec<T> w = fixed - on_axis(fixed);
        if (length(w) == 0) return std::nullopt;
        const Vec<T> nearest_point = onto_surface(fixed);
        return Capsule{nearest_point + k * (start - nearest_point), nearest_point + k * (end - nearest_point),
                       k * radius};
    }

    /// The line crosses the planes at the two ends in some order, and enters the infinite cylinder of the side once. If
    /// it enters the cylinder before the first plane, it enters the capsule by the ball at the first end; between the
    /// planes, by the side; and behind both, by the other ball. It leaves in the same way. A line parallel to the axis
    /// enters and leaves by the balls. A line parallel to the planes meets the side if it is between them, and the ball
    /// at an end if it is beyond that end. The side is that of the cylinder: with v = end − start, f = o − start, m = v
    /// × f and n = v × d, h = m·n, c = m² − r²v², a = n², q = v²(r²n² − (f·n)²).
    [[nodiscard]] JoinedSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), one(1);
        const Vec<T>& d = ray.direction;
        const Vec<T> v = axis(), f = ray.origin - start, m = cross(v, f), n = cross(v, d);
        const T v2 = square(v), r2 = square(radius), a = square(n), low = dot(v, f), rise = dot(v, d), d2 = square(d);
        const QuadraticSpan<T> side{dot(m, n), square(m) - r2 * v2, a, v2 * (r2 * a - square(dot(f, n))), d2};
        const QuadraticSpan<T> at_start = Sphere<T>{start, radius}.span(ray), at_end = Sphere<T>{end, radius}.span(ray);
        const auto up = rise > zero, is_parallel = !(up || rise < zero), below = low<zero, above = low> v2;
        const T size = select(up, rise, -rise);
        const Fraction<T> minus_infinity{-one, zero}, plus_infinity{one, zero};
        const Fraction<T> in_if_parallel = select(below, plus_infinity, minus_infinity),
                          out_if_parallel = select(above, minus_infinity, plus_infinity);
        const Fraction<T> t_in =
            select(is_parallel, in_if_parallel, select(up, Fraction<T>{-low, size}, Fraction<T>{low - v2, size}));
        const Fraction<T> t_out =
            select(is_parallel, out_if_parallel, select(up, Fraction<T>{v2 - low, size}, Fraction<T>{low, size}));
        const QuadraticSpan<T> first = select(up || (is_parallel && !above), at_start, at_end);
        const QuadraticSpan<T> last = select(up || (is_parallel && !below), at_end, at_start);
        const auto is_along_axis = a <= zero, in_before = quadratic_at(side, t_in).near_root().less;
        const auto in_between = quadratic_at(side, t_out).near_root().at_most;
        const auto out_before = quadratic_at(side, t_in).far_root().less;
        const auto out_between = quadratic_at(side, t_out).far_root().at_most;
        return {.enter = select(is_along_axis || in_before, first, select(in_between, side, last)),
                .leave = select(is_along_axis || !out_between, last, select(out_before, first, side)),
                .d2 = d2};
    }
    /// Returns the signed distance of a point from the surface, in units of `unit()`, positive outside.
    [[nodiscard]] T off_surface(const Vec<T>& p) const { return distance(p) / radius; }
    [[nodiscard]] T unit() const { return radius; }
    /// Returns the signed distance of a point from the surface, negative inside: |p − q| − r with q the point of the
    /// axis nearest to p.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - on_axis(p))) - radius; }
    /// Returns the outward unit normal at the point p of a ray: away from the axis.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> w = p - on_axis(p);
        const T k = T(1) / length(w);
        return {k * w.x, k * w.y, k * w.z};
    }
    [[nodiscard]] Vec<T> projected(const Ray<T>&, const Vec<T>& p) const { return onto_surface(p); }
    /// Returns the projected point with its error bound, which is that of the cylinder.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - start)) + radius;
        BoundedPoint<T> bounded{onto_surface(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(16) * size + gamma_bound<T>(3) * abs(start[i]);
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> axis() const { return end - start; }
    [[nodiscard]] Vec<T> on_axis(const Vec<T>& p) const {
        const Vec<T> v = axis();
        return start + min(max(dot(v, Vec<T>(p - start)) / square(v), T(0)), T(1)) * v;
    }
    [[nodiscard]] Vec<T> onto_surface(const Vec<T>& p) const {
        const Vec<T> q = on_axis(p), w = p - q;
        return q + (radius / length(w)) * w;
    }
};

}  // namespace lostbits
