// pbrt-v4's `pbrt_factored` in interval arithmetic. It misses only if the lower bound of the discriminant is negative.
// The bounds of t choose the first root, and the middle of its interval is the answer. A near root counts as in front
// only if its lower bound is positive.
#pragma once

#include "intersect/outward.hpp"
#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct PbrtInterval {
    static constexpr Info info{
        .name = "sphere.pbrt_interval",
        .title = "factored discriminant in interval arithmetic",
        .source = "Pharr, Jakob, Humphreys, pbrt-v4, section 6.2.2",
        .at_origin = AtOrigin::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        using I = OutwardInterval<T>;
        const I dx(ray.direction.x), dy(ray.direction.y), dz(ray.direction.z), r(sphere.radius), two(2), four(4);
        const I fx = I(ray.origin.x) - I(sphere.centre.x);
        const I fy = I(ray.origin.y) - I(sphere.centre.y);
        const I fz = I(ray.origin.z) - I(sphere.centre.z);

        const I a = square(dx) + square(dy) + square(dz);
        const I b = two * (dx * fx + dy * fy + dz * fz);
        const I c = square(fx) + square(fy) + square(fz) - square(r);

        const I s = b / (two * a);
        const I l = sqrt(square(fx - s * dx) + square(fy - s * dy) + square(fz - s * dz));
        const I disc = four * a * (r + l) * (r - l);

        const I root = sqrt(disc);
        const mask_t<T> is_ahead = named("b", b.middle()) < T(0);
        const I minus_half(-half<T>());
        const I minus = minus_half * (b - root), plus = minus_half * (b + root);
        const I q(select(is_ahead, minus.lo, plus.lo), select(is_ahead, minus.hi, plus.hi));
        const I over_a = q / a, under_c = c / q;
        const mask_t<T> is_swapped = over_a.lo > under_c.lo;
        const I near(select(is_swapped, under_c.lo, over_a.lo), select(is_swapped, under_c.hi, over_a.hi));
        const I far(select(is_swapped, over_a.lo, under_c.lo), select(is_swapped, over_a.hi, under_c.hi));

        const mask_t<T> use_far = near.lo <= T(0);
        const T t = named("t", select(use_far, far.middle(), near.middle()));
        return Hit<T>{!(disc.lo < T(0) || far.lo <= T(0)), t, near.middle(), far.middle()};
    }
};

}  // namespace lostbits::intersect::sphere
