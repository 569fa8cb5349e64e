// The quadratic of `schoolbook` with h = b/2.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct WeightedHalfB {
    static constexpr Info info{
        .name = "ellipsoid.half_b",
        .title = "weights 1/r^2, half b",
        .source = "Eberly, Geometric Tools, IntrRay3Ellipsoid3.h",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const WeightedQuadratic<T> q(ray, ellipsoid);
        const T disc = named("disc", square(q.h) - q.a * q.c);
        return hit_unless<T>(disc < T(0), plain_half_roots<T>(q.a, q.h, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
