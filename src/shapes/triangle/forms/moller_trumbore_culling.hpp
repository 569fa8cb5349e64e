// Möller and Trumbore's culling branch, as published. det > 0 if the ray meets the front, so one comparison rejects
// both rays from behind and parallel rays. u, v and t are divided at the end.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct MollerTrumboreCulling {
    static constexpr Info info{
        .name = "triangle.moller_trumbore_culling",
        .title = "Möller-Trumbore's culling branch, misses if det < 1e-6",
        .source = "Möller and Trumbore, J. Graphics Tools 2(1), 1997, TEST_CULL; t >= 0, which it leaves to the caller",
        .roots = Roots::first_only,
        .facing = Facing::front,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const T epsilon = T(1) / T(1000000), zero(0);
        const Vec<T> edge1 = triangle.b - triangle.a, edge2 = triangle.c - triangle.a;
        const Vec<T> pvec = cross(ray.direction, edge2);
        const T det = named("det", dot(edge1, pvec));
        const Vec<T> tvec = ray.origin - triangle.a;
        const T u = named("u*det", dot(tvec, pvec));
        const Vec<T> qvec = cross(tvec, edge1);
        const T v = named("v*det", dot(ray.direction, qvec));
        const T inverse = named("1/det", T(1) / det), t = named("t", dot(edge2, qvec) * inverse);
        named("u", u * inverse);
        named("v", v * inverse);
        return single_hit<T>(!(det < epsilon) && !(u < zero || u > det) && !(v < zero || u + v > det) && !(t < zero),
                             t);
    }
};

}  // namespace lostbits::intersect::triangle
