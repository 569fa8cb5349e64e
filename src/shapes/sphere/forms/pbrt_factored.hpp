// pbrt-v4: the difference of squares is factored, 4a(r + l)(r − l) with l = |f − (b/2a)d|. The roots are those of
// Press et al.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct PbrtFactored {
    static constexpr Info info{
        .name = "sphere.pbrt_factored",
        .title = "factored discriminant, Press et al. roots",
        .source = "Pharr, Jakob, Humphreys, pbrt-v4, section 6.2.2",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T l = named("l", length(f - (b / (T(2) * a)) * ray.direction));
        const T disc = named("disc", T(4) * a * (sphere.radius + l) * (sphere.radius - l));
        return hit_unless<T>(disc < T(0), press_roots<T>(a, b, c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
