// OptiX SDK sample: half-b roots, a miss if disc ≤ 0. If the near root is farther than ten radii, the form solves again
// from O + t d and adds the result. The second solution starts close to the sphere, where c cancels less. As in the
// sample, the first near root stays if the second discriminant is not positive.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct TwoStep {
    static constexpr Info info{
        .name = "sphere.two_step",
        .title = "half-b solved twice when far away",
        .source = "NVIDIA OptiX SDK, sphere.cu",
        .touching = Touching::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T h = named("h", dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T disc = named("disc", square(h) - a * c);
        const T root = sqrt(disc);
        const T first_t = named("t1", (-h - root) / a);
        const mask_t<T> is_far_away = abs(first_t) > T(10) * sphere.radius;
        const Vec<T> g = f + first_t * ray.direction;
        const T h2 = named("h2", dot(g, ray.direction));
        const T c2 = named("c2", square(g) - square(sphere.radius));
        const T disc2 = named("disc2", square(h2) - a * c2);
        const T root2 = sqrt(disc2);
        const mask_t<T> is_refined = is_far_away && disc2 > T(0);
        const T near = select(is_refined, first_t + (-h2 - root2) / a, first_t);
        const T far = select(is_refined, first_t + (-h2 + root2) / a, (-h + root) / a);
        return hit_unless<T>(disc <= T(0), RootPair<T>{near, far});
    }
};

}  // namespace lostbits::intersect::sphere
