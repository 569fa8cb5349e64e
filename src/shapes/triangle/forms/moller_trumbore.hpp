// Möller and Trumbore's determinants, with a miss if the first determinant is small. It is an area times the length of
// the direction, but is compared with a number without a unit.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct MollerTrumbore {
    static constexpr Info info{
        .name = "triangle.moller_trumbore",
        .title = "Möller-Trumbore, misses if |det| < 2^-23",
        .source = "bevy_picking 0909366, mesh_picking/ray_cast/intersections.rs:247",
        .roots = Roots::first_only,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const T epsilon = T(1) / T(1 << 23);  // f32::EPSILON in every format
        const Vec<T> e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a;
        const Vec<T> p = cross(ray.direction, e2);
        const T det = named("det", dot(e1, p));
        const T inverse = named("1/det", T(1) / det);
        const Vec<T> tvec = ray.origin - triangle.a;
        const T u = named("u", dot(tvec, p) * inverse);
        const Vec<T> q = cross(tvec, e1);
        const T v = named("v", dot(ray.direction, q) * inverse);
        const T t = named("t", dot(e2, q) * inverse);
        return single_hit<T>(
            !(abs(det) < epsilon) && u >= T(0) && u <= T(1) && !(v < T(0) || u + v > T(1)) && !(t < T(0)), t);
    }
};

}  // namespace lostbits::intersect::triangle
