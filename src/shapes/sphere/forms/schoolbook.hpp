// The schoolbook quadratic: a = d·d, b = 2 f·d, c = f·f − r², t = (−b ± √(b² − 4ac)) / 2a. A negative discriminant is
// a miss, so a ray that touches hits.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct Schoolbook {
    static constexpr Info info{
        .name = "sphere.schoolbook",
        .title = "schoolbook quadratic; a touching ray hits",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eqs. 2 and 3",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T disc = named("disc", square(b) - T(4) * a * c);
        return hit_unless<T>(disc < T(0), plain_roots<T>(a, b, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
