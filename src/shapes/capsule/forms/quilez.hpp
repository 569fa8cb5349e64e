// Quilez: the quadratic of the side from dot products, and the quadratic of one ball if the near root of the side is
// beyond an end. The form assumes unit directions and finds the near root only.
#pragma once

#include "shapes/capsule/forms/parts.hpp"

namespace lostbits::intersect::capsule {

struct QuilezCapsule {
    static constexpr Info info{
        .name = "capsule.quilez",
        .title = "dot products, unit direction, one ball by y",
        .source = "Quilez, Intersectors, capIntersect",
        .direction = Direction::unit,
        .roots = Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Capsule<T>& capsule) {
        const Vec<T> ba = capsule.end - capsule.start, oa = ray.origin - capsule.start, ob = ray.origin - capsule.end;
        const Vec<T>& rd = ray.direction;
        const T baba = named("baba", square(ba)), bard = named("bard", dot(ba, rd)), baoa = named("baoa", dot(ba, oa));
        const T r2 = square(capsule.radius);
        const T a = named("a", baba - square(bard)), b = named("b", baba * dot(rd, oa) - baoa * bard);
        const T c = named("c", baba * square(oa) - square(baoa) - r2 * baba);
        const T h = named("h", square(b) - a * c), t_side = named("t_side", (-b - sqrt(h)) / a);
        const T y = named("y", baoa + t_side * bard);
        const mask_t<T> is_on_side = y > T(0) && y < baba, is_below_start = y <= T(0);
        const Vec<T> oc(select(is_below_start, oa.x, ob.x), select(is_below_start, oa.y, ob.y),
                        select(is_below_start, oa.z, ob.z));
        const T b2 = named("b_ball", dot(rd, oc)), c2 = named("c_ball", square(oc) - r2);
        const T h2 = named("h_ball", square(b2) - c2), t = named("t", select(is_on_side, t_side, -b2 - sqrt(h2)));
        return {h >= T(0) && (is_on_side || h2 > T(0)) && t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::capsule
