// Press et al.: the schoolbook discriminant, then q = −½(b + sign(b)√disc), t₀ = c/q, t₁ = q/a.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct Press {
    static constexpr Info info{
        .name = "sphere.press",
        .title = "Press et al. roots, schoolbook discriminant",
        .source =
            "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eq. 6; Press et al., Numerical Recipes",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T disc = named("disc", square(b) - T(4) * a * c);
        return hit_unless<T>(disc < T(0), press_roots<T>(a, b, c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
