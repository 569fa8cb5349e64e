// The ray divided by the radii and tested with the unit sphere: half b, plain roots.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct ScaledHalfB {
    static constexpr Info info{
        .name = "ellipsoid.scaled",
        .title = "ray divided by the radii, half b",
        .source = "Quilez, Intersectors, eliIntersect",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const ScaledRay<T> scaled_ray(ray, ellipsoid);
        const T a = named("a", square(scaled_ray.d));
        const T h = named("h", dot(scaled_ray.f, scaled_ray.d));
        const T c = named("c", square(scaled_ray.f) - T(1));
        const T disc = named("disc", square(h) - a * c);
        return hit_unless<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
