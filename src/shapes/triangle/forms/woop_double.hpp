// Woop's test with edge values that are differences of rounded products. If one of them is zero, all are computed again
// in double.
#pragma once

#include "shapes/triangle/forms/woop_pbrt.hpp"

namespace lostbits::intersect::triangle {

struct WoopDouble {
    static constexpr Info info{
        .name = "triangle.woop_double",
        .title = "Woop's watertight test, zeros again in double",
        .source = "Woop, Benthin and Wald, JCGT 2(1), 2013; pbrt-v3, src/shapes/triangle.cpp, less its last test",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"b0", "b1", "b2"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const WoopVertices<T> v(ray, triangle);
        const WoopEdges<T> e(v, [](const T& a, const T& b, const T& c, const T& d) { return a * b - c * d; });
        const WoopHit<T> woop_hit = hit_from_edges(triangle, v, e);
        return single_hit<T>(woop_hit.hit, woop_hit.t);
    }
};

}  // namespace lostbits::intersect::triangle
