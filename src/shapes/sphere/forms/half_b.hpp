// The schoolbook quadratic with h = b/2: t = (−h ± √(h² − ac)) / a. Dividing by 2 and 4 is exact, so this
// should lose exactly what `schoolbook` loses.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct HalfB {
    static constexpr Info info{
        .name = "sphere.half_b",
        .title = "schoolbook with half b",
        .source = "Shirley, Ray Tracing in One Weekend",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T h = named("h", dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T disc = named("disc", square(h) - a * c);
        return hit_unless<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
