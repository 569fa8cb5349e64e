// Quilez: the quadratic k2 t² + 2 k1 t + k0 of the side from dot products, k2 = ba·ba − bard² and so on. The form
// assumes unit directions. The sign of the position along the axis chooses the cap.
#pragma once

#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct QuilezCylinder {
    static constexpr Info info{
        .name = "cylinder.quilez",
        .title = "dot products, unit direction, the cap by y",
        .source = "Quilez, Intersectors, cylIntersect",
        .direction = Direction::unit,
        .roots = Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const Vec<T> ba = cylinder.top - cylinder.base, oc = ray.origin - cylinder.base;
        const Vec<T>& rd = ray.direction;
        const T baba = named("baba", square(ba)), bard = named("bard", dot(ba, rd)), baoc = named("baoc", dot(ba, oc));
        const T k2 = named("k2", baba - square(bard));
        const T k1 = named("k1", baba * dot(oc, rd) - baoc * bard);
        const T k0 = named("k0", baba * square(oc) - square(baoc) - square(cylinder.radius) * baba);
        const T h = named("h", square(k1) - k2 * k0), root = sqrt(h);
        const T t_side = named("t_side", (-k1 - root) / k2), y = named("y", baoc + t_side * bard);
        const T t_cap = named("t_cap", (select(y < T(0), T(0), baba) - baoc) / bard);
        const mask_t<T> is_on_side = y > T(0) && y < baba, is_on_cap = abs(k1 + k2 * t_cap) < root;
        const T t = select(is_on_side, t_side, t_cap);
        return {!(h < T(0)) && (is_on_side || is_on_cap) && t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::cylinder
