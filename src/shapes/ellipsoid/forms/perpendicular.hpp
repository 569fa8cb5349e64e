// Hearn and Baker's discriminant in the coordinates of the unit sphere, 1 − |f − ((f·d)/(d·d)) d|², and stable roots.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct ScaledPerpendicular {
    static constexpr Info info{
        .name = "ellipsoid.perpendicular",
        .title = "ray divided by the radii, perpendicular from the centre",
        .source = "NAIF SPICE, surfpt.f: the part of the scaled position that is perpendicular to the line",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const ScaledRay<T> scaled_ray(ray, ellipsoid);
        const T a = named("a", square(scaled_ray.d));
        // The quadratic is a t² + 2 b t + c with b = f·d. As for spheres, b' is −b.
        const T minus_b = named("b'", -dot(scaled_ray.f, scaled_ray.d));
        const Vec<T> perpendicular = scaled_ray.f + (minus_b / a) * scaled_ray.d;
        const T delta = named("delta", T(1) - square(perpendicular));
        const T c = named("c", square(scaled_ray.f) - T(1));
        return hit_unless<T>(delta < T(0), unified_roots<T>(a, minus_b, c, sqrt(a * delta)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
