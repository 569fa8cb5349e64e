// The normal is computed once for each triangle, and barycentric coordinates may be as low as −ε. So a ray near an edge
// that two triangles share hits both.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct PrecomputedNormal {
    static constexpr Info info{
        .name = "triangle.precomputed_normal",
        .title = "normal first, u, v and w at least -epsilon",
        .source = "madmann91/bvh 327b67b, src/bvh/v2/tri.h:57",
        .roots = Roots::first_only,
        .weights = {"w", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const T least = -(T(2) * unit_roundoff<T>());  // the format's own epsilon
        const Vec<T> e1 = triangle.a - triangle.b, e2 = triangle.c - triangle.a, n = cross(e1, e2);
        const Vec<T> c = triangle.a - ray.origin, r = cross(ray.direction, c);
        const T inverse = named("1/det", T(1) / dot(n, ray.direction));
        const T u = named("u", dot(r, e2) * inverse), v = named("v", dot(r, e1) * inverse);
        const T w = named("w", T(1) - u - v);
        const T t = named("t", dot(n, c) * inverse);
        return single_hit<T>(u >= least && v >= least && w >= least && t >= T(0), t);
    }
};

}  // namespace lostbits::intersect::triangle
