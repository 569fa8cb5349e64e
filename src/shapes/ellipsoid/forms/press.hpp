// The quadratic of `schoolbook` with the roots of Press et al., which subtract no numbers of similar size.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct WeightedPress {
    static constexpr Info info{
        .name = "ellipsoid.press",
        .title = "weights 1/r^2, roots of Press et al.",
        .source = "glob3mobile g3m, Ellipsoid.cpp, intersectionsDistances",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const WeightedQuadratic<T> q(ray, ellipsoid);
        const T b = named("b", T(2) * q.h);
        const T disc = named("disc", square(b) - T(4) * q.a * q.c);
        return hit_unless<T>(disc < T(0), press_roots<T>(q.a, b, q.c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
