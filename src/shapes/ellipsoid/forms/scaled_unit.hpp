// An instance of the unit sphere whose ray is normalised in its own coordinates: a = 1, and t is divided by the length
// that normalising removed.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct ScaledUnit {
    static constexpr Info info{
        .name = "ellipsoid.scaled_unit",
        .title = "instance of the unit sphere, direction normalised there",
        .source = "bevy, Dir3::new of a ray taken into object space; Unity and others likewise",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const ScaledRay<T> scaled_ray(ray, ellipsoid);
        const T size = named("size", length(scaled_ray.d));
        const Vec<T> d(scaled_ray.d.x / size, scaled_ray.d.y / size, scaled_ray.d.z / size);
        const T h = named("h", dot(scaled_ray.f, d));
        const T c = named("c", square(scaled_ray.f) - T(1));
        const T disc = named("disc", square(h) - c);
        const T root = sqrt(disc);
        return hit_unless<T>(disc < T(0), RootPair<T>{(-h - root) / size, (-h + root) / size});
    }
};

}  // namespace lostbits::intersect::ellipsoid
