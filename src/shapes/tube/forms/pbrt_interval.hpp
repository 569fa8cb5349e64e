// pbrt-v4's cylinder: the ray is transformed into a frame along the axis, and the rest is in interval arithmetic, with
// the discriminant factored. The line misses the wall only if the lower bound of the discriminant is negative. A root
// is in front if its lower bound is positive.
#pragma once

#include "intersect/outward.hpp"
#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct PbrtTube {
    static constexpr Info info{
        .name = "tube.pbrt_interval",
        .title = "factored discriminant in interval arithmetic",
        .source = "pbrt-v4, src/pbrt/shapes.h, Cylinder::BasicIntersect",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        using I = OutwardInterval<T>;
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const I ox(o.x), oy(o.y), dx(d.x), dy(d.y), r(tube.radius), two(2), four(4);
        const I a = square(dx) + square(dy), b = two * (dx * ox + dy * oy), c = square(ox) + square(oy) - square(r);
        const I f = b / (two * a), l = sqrt(square(ox - f * dx) + square(oy - f * dy));
        const I disc = four * a * (r + l) * (r - l), root = sqrt(disc), minus_half(-half<T>());

        // The roots q/a and c/q, without a difference of close numbers, in order.
        const auto is_ahead = named("b", b.middle()) < T(0);
        const I minus = minus_half * (b - root), plus = minus_half * (b + root);
        const I q(select(is_ahead, minus.lo, plus.lo), select(is_ahead, minus.hi, plus.hi));
        const I over_a = q / a, under_c = c / q;
        const auto is_swapped = over_a.lo > under_c.lo;
        const I near(select(is_swapped, under_c.lo, over_a.lo), select(is_swapped, under_c.hi, over_a.hi));
        const I far(select(is_swapped, over_a.lo, under_c.lo), select(is_swapped, over_a.hi, under_c.hi));

        const auto is_on_wall = [&](const I& t) {
            const T z = o.z + t.middle() * d.z;
            return t.lo > T(0) && z >= T(0) && z <= frame.height;
        };
        const auto is_near_on_wall = is_on_wall(near);
        const T t = named("t", select(is_near_on_wall, near.middle(), far.middle()));
        return {!(disc.lo < T(0)) && (is_near_on_wall || is_on_wall(far)), t, t, t};
    }
};

}  // namespace lostbits::intersect::tube
