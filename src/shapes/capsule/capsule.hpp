// The capsule.
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
         {.name = "end", .letter = "e", .limit = Key::Limit::apart_from_before},
         {.name = "radius", .letter = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// Builds a capsule along z. A quarter of its length at each end is round.
    static Capsule around(const Vec<T>& p, const T& half) {
        const T r = half / T(2);
        return {{p.x, p.y, p.z - r}, {p.x, p.y, p.z + r}, r};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * start + (T(1) / T(2)) * end; }
    /// Half of its length.
    [[nodiscard]] T half_extent() const { return radius + length(axis()) / T(2); }
    [[nodiscard]] Sphere<T> ball_around() const { return {middle(), half_extent()}; }
    /// A point near the axis: at the fraction u.x of the axis, and moved within a cube of side 2 `radius`.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const T k = 2 * radius;
        return start + u.x * axis() + Vec<T>((u.x - T(1) / 2) * k, (u.y - T(1) / 2) * k, (u.z - T(1) / 2) * k);
    }
    /// Scales it by k and keeps its point nearest to `still` where it was. Returns nothing if no point is nearest.
    [[nodiscard]] std::optional<Capsule> grown(const Vec<T>& still, const T& k) const {
        const Vec<T> w = still - on_axis(still);
        if (length(w) == 0) return std::nullopt;
        const Vec<T> there = onto_surface(still);
        return Capsule{there + k * (start - there), there + k * (end - there), k * radius};
    }

    /// The line passes the planes at the two ends in some order. It enters by the ball at the first end if it enters
    /// the side before the first plane, by the side if it does so between the planes, and by the other ball if it does
    /// so behind both. It leaves in the same way. A line parallel to the axis enters and leaves by the balls. A line
    /// parallel to the planes meets the side if it is between them, and the ball at an end if it is beyond that end.
    /// The side is that of the cylinder: with v = end − start, f = o − start, m = v × f and n = v × d, h = m·n, c = m²
    /// − r²v², a = n², q = v²(r²n² − (f·n)²).
    [[nodiscard]] JoinedSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), one(1);
        const Vec<T>& d = ray.direction;
        const Vec<T> v = axis(), f = ray.origin - start, m = cross(v, f), n = cross(v, d);
        const T v2 = square(v), r2 = square(radius), a = square(n), low = dot(v, f), across = dot(v, d), d2 = square(d);
        const QuadraticSpan<T> side{dot(m, n), square(m) - r2 * v2, a, v2 * (r2 * a - square(dot(f, n))), d2};
        const QuadraticSpan<T> at_start = Sphere<T>{start, radius}.span(ray), at_end = Sphere<T>{end, radius}.span(ray);
        const auto up = across > zero, still = !(up || across < zero), below = low<zero, above = low> v2;
        const T size = select(up, across, -across);
        const Fraction<T> before{-one, zero}, after{one, zero};
        const Fraction<T> none_in = select(below, after, before), none_out = select(above, before, after);
        const Fraction<T> in = select(still, none_in, select(up, Fraction<T>{-low, size}, Fraction<T>{low - v2, size}));
        const Fraction<T> out =
            select(still, none_out, select(up, Fraction<T>{v2 - low, size}, Fraction<T>{low, size}));
        const QuadraticSpan<T> first = select(up || (still && !above), at_start, at_end);
        const QuadraticSpan<T> last = select(up || (still && !below), at_end, at_start);
        const auto beside = a <= zero, in_before = quadratic_at(side, in).near_root().less;
        const auto in_between = quadratic_at(side, out).near_root().at_most;
        const auto out_before = quadratic_at(side, in).far_root().less;
        const auto out_between = quadratic_at(side, out).far_root().at_most;
        return {.enter = select(beside || in_before, first, select(in_between, side, last)),
                .leave = select(beside || !out_between, last, select(out_before, first, side)),
                .d2 = d2};
    }
    /// Relative distance of a point outside, in units of `unit()`.
    [[nodiscard]] T off_surface(const Vec<T>& p) const { return distance(p) / radius; }
    [[nodiscard]] T unit() const { return radius; }
    /// Signed distance of a point from the surface, negative inside: |p − q| − r with q the point of the axis nearest
    /// to p.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - on_axis(p))) - radius; }
    /// The outward unit normal at the point p of a ray: away from the axis.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> w = p - on_axis(p);
        const T k = T(1) / length(w);
        return {k * w.x, k * w.y, k * w.z};
    }
    [[nodiscard]] Vec<T> projected(const Ray<T>&, const Vec<T>& p) const { return onto_surface(p); }
    /// The projected point with its error, which is that of the cylinder.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - start)) + radius;
        BoundedPoint<T> b{onto_surface(p), p};
        for (int i = 0; i < 3; ++i) b.delta[i] = gamma_bound<T>(16) * size + gamma_bound<T>(3) * abs(start[i]);
        return b;
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
