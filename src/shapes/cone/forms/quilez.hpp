// Quilez: the caps first, then the quadratic k2 t² + 2 k1 t + k0 of the side. The form assumes unit directions.
#pragma once

#include "shapes/cone/forms/parts.hpp"

namespace lostbits::intersect::cone {

struct QuilezCone {
    static constexpr Info info{
        .name = "cone.quilez",
        .title = "caps first, dot products, unit direction",
        .source = "Quilez, Intersectors, coneIntersect",
        .direction = Direction::unit,
        .roots = Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const T zero(0), ra = cone.base_radius, rb = cone.top_radius;
        const Vec<T>& rd = ray.direction;
        const Vec<T> ba = cone.top - cone.base, oa = ray.origin - cone.base, ob = ray.origin - cone.top;
        const T m0 = named("m0", dot(ba, ba)), m1 = named("m1", dot(oa, ba)), m2 = named("m2", dot(rd, ba));
        const T m3 = named("m3", dot(rd, oa)), m5 = named("m5", dot(oa, oa)), m9 = named("m9", dot(ob, ba));
        const T t_top = -m9 / m2, rr = ra - rb, hy = named("hy", m0 + square(rr));
        const auto is_below = m1<zero, is_above = m9> zero;
        const auto is_on_base = is_below && square(Vec<T>(m2 * oa - m1 * rd)) < square(ra) * square(m2);
        const auto is_on_top = !is_below && is_above && square(Vec<T>(ob + t_top * rd)) < square(rb);
        const T k2 = named("k2", square(m0) - square(m2) * hy);
        const T k1 = named("k1", square(m0) * m3 - m1 * m2 * hy + m0 * ra * (rr * m2));
        const T k0 = named("k0", square(m0) * m5 - square(m1) * hy + m0 * ra * (T(2) * (rr * m1) - m0 * ra));
        const T h = named("h", square(k1) - k2 * k0), t_side = (-k1 - sqrt(h)) / k2, y = named("y", m1 + t_side * m2);
        const auto is_on_side = !(h < zero) && !(y < zero || y > m0);
        const T t = named("t", select(is_on_base, -m1 / m2, select(is_on_top, t_top, t_side)));
        return {(is_on_base || is_on_top || is_on_side) && t >= zero, t, t, t};
    }
};

}  // namespace lostbits::intersect::cone
