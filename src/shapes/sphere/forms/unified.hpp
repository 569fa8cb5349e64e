// The discriminant of `hearn_baker` with the roots of `press`: Δ = r² − |f + (b'/a)d|², b' = −f·d, q = b' +
// sign(b')√(aΔ), t₀ = c/q, t₁ = q/a.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct Unified {
    static constexpr Info info{
        .name = "sphere.unified",
        .title = "Hearn and Baker discriminant, Press et al. roots",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eqs. 7-10",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> l = f + (minus_b / a) * ray.direction;
        const T delta = named("delta", square(sphere.radius) - square(l));

        const T c = named("c", square(f) - square(sphere.radius));
        return hit_unless<T>(delta < T(0), unified_roots<T>(a, minus_b, c, sqrt(a * delta)));
    }
};

}  // namespace lostbits::intersect::sphere
