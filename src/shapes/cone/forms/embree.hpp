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

        // The quadratic a t² + 2 b t + c of the side, from the moved origin.
        const T v2 = square(v), v_dot_f = dot(p0, v), v_dot_g = dot(p1, v), axis_rate = dot(d, v), v4 = square(v2);
        const T dr = cone.base_radius - cone.top_radius, hy = v2 + square(dr), r0 = v2 * cone.base_radius;
        const T a = named("A", v4 - square(axis_rate) * hy);
        const T b = named("B", v4 * dot(d, p0) - v_dot_f * axis_rate * hy + r0 * (dr * axis_rate));
        const T c = named("C", v4 * square(p0) - square(v_dot_f) * hy + r0 * (T(2) * dr * v_dot_f - r0));
        const T disc = named("D", square(b) - a * c), root = sqrt(disc), inverse_a = T(1) / a,
                inverse_axis_rate = T(1) / axis_rate;

        // The two crossings of the side, and those of the caps.
        const auto cross_side = [&](const T& t) {
            const T y = v_dot_f + t * axis_rate;
            return Crossing<T>{y > T(0) && y < v2, t};
        };
        const auto cross_cap = [&](const Vec<T>& p, const T& y, const T& radius) {
            const mask_t<T> is_within = square(Vec<T>(axis_rate * p - y * d)) < square(radius) * square(axis_rate);
            return Crossing<T>{is_within, -y * inverse_axis_rate};
        };
        const Crossing<T> near = cross_side((-b - root) * inverse_a), far = cross_side((-b + root) * inverse_a);
        const Crossing<T> base_cap = cross_cap(p0, v_dot_f, cone.base_radius),
                          top_cap = cross_cap(p1, v_dot_g, cone.top_radius);

        // The line enters at the first crossing and leaves at the last.
        const Crossing<T> first_cap = earlier<T>(base_cap, top_cap),
                          last_cap{base_cap.is_crossed && top_cap.is_crossed, max(base_cap.t, top_cap.t)};
        const mask_t<T> enters_by_cap = first_cap.is_crossed && (!near.is_crossed || first_cap.t <= near.t);
        const Crossing<T> entry = earlier<T>(near, first_cap),
                          exit = later<T>(far, choose<T>(enters_by_cap, last_cap, first_cap));

        const T t_in = named("enter", dt + entry.t), t_out = named("leave", dt + exit.t);
        const mask_t<T> is_entry_ahead = entry.is_crossed && t_in >= T(0);
        const T t = named("t", select(is_entry_ahead, t_in, t_out));
        return {disc >= T(0) && (is_entry_ahead || (exit.is_crossed && t_out >= T(0))), t, t, t};
    }

private:
    /// The t at which the line crosses a part of the surface. `is_crossed` is false if it does not cross the part.
    template <Number T>
    struct Crossing {
        mask_t<T> is_crossed;
        T t;
    };
    template <Number T>
    static Crossing<T> choose(const mask_t<T>& use_a, const Crossing<T>& a, const Crossing<T>& b) {
        return {(use_a && a.is_crossed) || (!use_a && b.is_crossed), select(use_a, a.t, b.t)};
    }
    template <Number T>
    static Crossing<T> earlier(const Crossing<T>& a, const Crossing<T>& b) {
        return choose<T>(a.is_crossed && (!b.is_crossed || a.t <= b.t), a, b);
    }
    template <Number T>
    static Crossing<T> later(const Crossing<T>& a, const Crossing<T>& b) {
        return choose<T>(a.is_crossed && (!b.is_crossed || b.t <= a.t), a, b);
    }
};

}  // namespace lostbits::intersect::cone
