// Möller and Trumbore's determinants, each times the reciprocal of the first. So u + v ≤ 1 rounds for each triangle
// separately. (Dr.Jit contracts products and sums where the machine can; here every operation rounds.)
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
        const Vec<T> from = ray.origin - triangle.a;
        const T u = named("u", dot(from, p) * inverse);
        const Vec<T> q = cross(from, e1);
        const T v = named("v", dot(ray.direction, q) * inverse);
        const T t = named("t", dot(e2, q) * inverse);
        return met<T>(u >= T(0) && u <= T(1) && v >= T(0) && u + v <= T(1) && t >= T(0), t);
    }
};

}  // namespace lostbits::intersect::triangle
