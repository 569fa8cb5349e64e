// `unified`, then one Newton step on g(t) = |f + t d|² − r²: t − g / (2 (f + t d)·d). At a point of tangency the
// derivative is zero; the root is kept there.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct NewtonRefined {
    static constexpr Info info{
        .name = "sphere.newton_refined",
        .title = "unified and one Newton step",
        .source = "-",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> l = f + (minus_b / a) * ray.direction;
        const T delta = named("delta", square(sphere.radius) - square(l));

        const T c = named("c", square(f) - square(sphere.radius));
        const RootPair<T> roots = unified_roots<T>(a, minus_b, c, sqrt(a * delta));
        const auto refine = [&](const T& t) {
            const Vec<T> p = f + t * ray.direction;
            const T slope = T(2) * dot(p, ray.direction);
            const T g = named("g", square(p) - square(sphere.radius));
            return select(abs(slope) > T(0), t - g / slope, t);
        };
        return hit_unless<T>(delta < T(0), RootPair<T>{refine(roots.near), refine(roots.far)});
    }
};

}  // namespace lostbits::intersect::sphere
