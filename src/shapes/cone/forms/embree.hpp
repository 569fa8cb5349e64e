// Embree's flat curve of cone segments with both caps. The origin is moved to the foot of the perpendicular from the
// middle, everything is multiplied out, and the nearest of side and caps decides.
#pragma once

#include "shapes/cone/forms/parts.hpp"

namespace lostbits::intersect::cone {

struct EmbreeCone {
    static constexpr Info info{
        .name = "cone.embree",
        .title = "origin moved near the middle, multiplied out",
        .source = "Embree 4.3.1, kernels/geometry/coneline_intersector.h:19, intersectCone, with both caps",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const Vec<T>& d = ray.direction;
        const Vec<T> middle = half<T>() * (cone.base + cone.top);
        const T dt = named("dt", dot(middle - ray.origin, d) * (T(1) / square(d)));
        const Vec<T> o = ray.origin + dt * d, v = cone.top - cone.base, p0 = o - cone.base, p1 = o - cone.top;
        const T v2 = square(v), low = dot(p0, v), high = dot(p1, v), axis_rate = dot(d, v), v4 = square(v2);
        const T dr = cone.base_radius - cone.top_radius, hy = v2 + square(dr), r0 = v2 * cone.base_radius;
        const T a = named("A", v4 - square(axis_rate) * hy);
        const T b = named("B", v4 * dot(d, p0) - low * axis_rate * hy + r0 * (dr * axis_rate));
        const T c = named("C", v4 * square(p0) - square(low) * hy + r0 * (T(2) * dr * low - r0));
        const T disc = named("D", square(b) - a * c), root = sqrt(disc), over_a = T(1) / a, over = T(1) / axis_rate;
        const auto on_side = [&](const T& t) {
            const T y = low + t * axis_rate;
            return Crossing<T>{y > T(0) && y < v2, t};
        };
        const auto on_cap = [&](const Vec<T>& p, const T& y, const T& radius) {
            const mask_t<T> is_within = square(Vec<T>(axis_rate * p - y * d)) < square(radius) * square(axis_rate);
            return Crossing<T>{is_within, -y * over};
        };
        const Crossing<T> near = on_side((-b - root) * over_a), far = on_side((-b + root) * over_a);
        const Crossing<T> cap0 = on_cap(p0, low, cone.base_radius), cap1 = on_cap(p1, high, cone.top_radius);
        const Crossing<T> cap = earlier<T>(cap0, cap1), last_cap{cap0.counts && cap1.counts, max(cap0.t, cap1.t)};
        const mask_t<T> enters_by_cap = cap.counts && (!near.counts || cap.t <= near.t);
        const Crossing<T> enter = earlier<T>(near, cap), leave = later<T>(far, chosen<T>(enters_by_cap, last_cap, cap));
        const T t_in = named("enter", dt + enter.t), t_out = named("leave", dt + leave.t);
        const mask_t<T> enters = enter.counts && t_in >= T(0);
        const T t = named("t", select(enters, t_in, t_out));
        return {disc >= T(0) && (enters || (leave.counts && t_out >= T(0))), t, t, t};
    }

private:
    /// The t at which the line crosses a part of the surface. `counts` is false if it does not cross the part.
    template <Number T>
    struct Crossing {
        mask_t<T> counts;
        T t;
    };
    template <Number T>
    static Crossing<T> chosen(const mask_t<T>& use_a, const Crossing<T>& a, const Crossing<T>& b) {
        return {(use_a && a.counts) || (!use_a && b.counts), select(use_a, a.t, b.t)};
    }
    template <Number T>
    static Crossing<T> earlier(const Crossing<T>& a, const Crossing<T>& b) {
        return chosen<T>(a.counts && (!b.counts || a.t <= b.t), a, b);
    }
    template <Number T>
    static Crossing<T> later(const Crossing<T>& a, const Crossing<T>& b) {
        return chosen<T>(a.counts && (!b.counts || b.t <= a.t), a, b);
    }
};

}  // namespace lostbits::intersect::cone
