// `unified` with a shortcut. If a ray starts outside and the sphere is behind it (b' < 0 and c > 0), it misses. The
// sign of c says which root is the first: t₀ from outside, t₁ from inside. Only that root is computed. On the surface
// (c = 0, a case that the source does not mention) the first root is c/q = 0 for every direction of the ray.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct EarlyExit {
    static constexpr Info info{
        .name = "sphere.early_exit",
        .title = "unified, sign of c picks the root",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), section 7.2",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> l = f + (minus_b / a) * ray.direction;
        const T delta = named("delta", square(sphere.radius) - square(l));

        const T c = named("c", square(f) - square(sphere.radius));
        const mask_t<T> is_outside = c > T(0);
        const mask_t<T> is_behind = minus_b < T(0);
        const T root = sqrt(a * delta);
        const T q = named("q", minus_b + select(is_behind, -root, root));
        // Inside, the far root is q/a if the centre is ahead, c/q if it is behind. Otherwise near = c/q.
        const T t = named("t", select(c < T(0) && !is_behind, q / a, c / q));
        return Hit<T>{!(delta < T(0) || (is_behind && is_outside)), t, t, t};
    }
};

}  // namespace lostbits::intersect::sphere
