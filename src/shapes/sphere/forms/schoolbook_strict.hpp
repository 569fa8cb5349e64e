// The schoolbook quadratic as shaders often write it: touching (discriminant zero) is a miss. It differs from
// `schoolbook` only in the strictness of one comparison.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct SchoolbookStrict {
    static constexpr Info info{
        .name = "sphere.schoolbook_strict",
        .title = "schoolbook quadratic; a touching ray misses",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eqs. 2 and 3 with disc <= 0 a miss",
        .touching = Touching::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T disc = named("disc", square(b) - T(4) * a * c);
        return hit_unless<T>(disc <= T(0), plain_roots<T>(a, b, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
