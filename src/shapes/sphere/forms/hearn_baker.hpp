// Hearn and Baker: b² − 4ac = 4a(r² − |f − (f·d̂)d̂|²), d̂ = d/|d|. The components are subtracted before
// they are squared; the roots stay plain.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct HearnBaker {
    static constexpr Info info{
        .name = "sphere.hearn_baker",
        .title = "Hearn and Baker discriminant, plain roots",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eq. 5; Hearn and Baker",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T len = sqrt(a);
        const Vec<T> unit(ray.direction.x / len, ray.direction.y / len, ray.direction.z / len);
        const Vec<T> l = f - dot(f, unit) * unit;
        const T disc = named("disc", T(4) * a * (square(sphere.radius) - square(l)));
        return hit_unless<T>(disc < T(0), plain_roots<T>(a, b, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
