// Lagrange's identity: the discriminant is (d/r)² − Σ (m/(r r'))² with the moment m = f × d, each component divided by
// the radii of the other two axes. The moment is that of the ray before scaling, so nothing is divided before it
// cancels.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct MomentDiscriminant {
    static constexpr Info info{
        .name = "ellipsoid.moment",
        .title = "Lagrange's identity, the moment before the division",
        .source = "Lagrange's identity",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const ScaledRay<T> scaled_ray(ray, ellipsoid);
        const Vec<T> m = cross(Vec<T>(ray.origin - ellipsoid.centre), ray.direction);
        const Vec<T> scaled_moment(m.x / ellipsoid.radii.y / ellipsoid.radii.z,
                                   m.y / ellipsoid.radii.z / ellipsoid.radii.x,
                                   m.z / ellipsoid.radii.x / ellipsoid.radii.y);
        const T a = named("a", square(scaled_ray.d));
        const T minus_b = named("b'", -dot(scaled_ray.f, scaled_ray.d));
        const T disc = named("disc", a - square(scaled_moment));
        const T c = named("c", square(scaled_ray.f) - T(1));
        return hit_unless<T>(disc < T(0), unified_roots<T>(a, minus_b, c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
