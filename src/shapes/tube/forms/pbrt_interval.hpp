// pbrt-v4's cylinder: the ray is transformed into a frame along the axis, and the rest is in interval arithmetic, with
// the discriminant factored. It misses only if the lower bound of the discriminant is negative. A root counts as in
// front if its lower bound is positive.
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
        using I = Outward<T>;
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.into(ray.origin - tube.bottom), d = frame.into(ray.direction);
        const I ox(o.x), oy(o.y), dx(d.x), dy(d.y), r(tube.radius), two(2), four(4);
        const I a = square(dx) + square(dy), b = two * (dx * ox + dy * oy), c = square(ox) + square(oy) - square(r);
        const I f = b / (two * a), l = sqrt(square(ox - f * dx) + square(oy - f * dy));
        const I disc = four * a * (r + l) * (r - l), root = sqrt(disc), minus_half(-half<T>());
        const auto ahead = named("b", b.middle()) < T(0);
        const I minus = minus_half * (b - root), plus = minus_half * (b + root);
        const I q(select(ahead, minus.lo, plus.lo), select(ahead, minus.hi, plus.hi));
        const I one = q / a, other = c / q;
        const auto swapped = one.lo > other.lo;
        const I near(select(swapped, other.lo, one.lo), select(swapped, other.hi, one.hi));
        const I far(select(swapped, one.lo, other.lo), select(swapped, one.hi, other.hi));
        const auto met = [&](const I& t) {
            const T z = o.z + t.middle() * d.z;
            return t.lo > T(0) && z >= T(0) && z <= frame.height;
        };
        const auto by_near = met(near);
        const T t = named("t", select(by_near, near.middle(), far.middle()));
        return {!(disc.lo < T(0)) && (by_near || met(far)), t, t, t};
    }
};

}  // namespace lostbits::intersect::tube
