// The quadratic as most code writes it, with 1/r² as weights, b and 4ac, and the plain roots.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct WeightedSchoolbook {
    static constexpr Info info{
        .name = "ellipsoid.schoolbook",
        .title = "weights 1/r^2, schoolbook quadratic",
        .source = "Cozzi and Ring, 3D Engine Design for Virtual Globes (2011), section 4.3, RayIntersectEllipsoid",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const WeightedQuadratic<T> q(ray, ellipsoid);
        const T b = named("b", T(2) * q.h);
        const T disc = named("disc", square(b) - T(4) * q.a * q.c);
        return hit_unless<T>(disc < T(0), plain_roots<T>(q.a, b, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
