// Lagrange's identity: aΔ = a r² − |f × d|². The cross product cancels before anything is squared, so it keeps the
// digits that f·f − (f·d)²/a loses. The roots are those of `unified`.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct CrossProduct {
    static constexpr Info info{
        .name = "sphere.cross_product",
        .title = "Lagrange's identity for the discriminant",
        .source = "Lagrange's identity",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> m = cross(f, ray.direction);
        const T disc = named("disc", a * square(sphere.radius) - square(m));
        const T c = named("c", square(f) - square(sphere.radius));
        return hit_unless<T>(disc < T(0), unified_roots<T>(a, minus_b, c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
