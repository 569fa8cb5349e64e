// Möller and Trumbore's determinants, each multiplied by the reciprocal of the first. So u + v ≤ 1 rounds differently
// in two triangles that share an edge. (Dr.Jit contracts products and sums if the machine can; here every operation
// rounds.)
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct ReciprocalFirst {
    static constexpr Info info{
        .name = "triangle.reciprocal_first",
        .title = "Möller-Trumbore, times 1/det before the tests",
        .source = "Mitsuba 3 003422d, include/mitsuba/render/mesh.h, moeller_trumbore",
        .roots = Roots::first_only,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a;
        const Vec<T> p = cross(ray.direction, e2);
        const T inverse = named("1/det", T(1) / dot(e1, p));
        const Vec<T> tvec = ray.origin - triangle.a;
        const T u = named("u", dot(tvec, p) * inverse);
        const Vec<T> q = cross(tvec, e1);
        const T v = named("v", dot(ray.direction, q) * inverse);
        const T t = named("t", dot(e2, q) * inverse);
        return single_hit<T>(u >= T(0) && u <= T(1) && v >= T(0) && u + v <= T(1) && t >= T(0), t);
    }
};

}  // namespace lostbits::intersect::triangle
