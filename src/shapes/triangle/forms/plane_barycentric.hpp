// The point at which the line meets the plane with a unit normal, and its barycentric coordinates by Cramer's rule. In
// float, the rounding error of the point is much larger than the tolerance of 1e-13.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct PlaneBarycentric {
    static constexpr Info info{
        .name = "triangle.plane_barycentric",
        .title = "the point on the plane, then its coordinates",
        .source = "trimesh 06350f1, trimesh/ray/ray_triangle.py:170 and triangles.py; t >= 0 and not -1e-6",
        .roots = Roots::first_only,
        .weights = {"a", "b", "c"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const T tolerance = T(1) / (T(1000000) * T(10000000)), zero(0);
        const Vec<T> e0 = triangle.b - triangle.a, e1 = triangle.c - triangle.a, n = cross(e0, e1);
        const Vec<T> unit = (T(1) / length(n)) * n;
        const T plane_distance = named("from", dot(triangle.a - ray.origin, unit));
        const T slope = named("along", dot(ray.direction, unit));
        const T t = named("t", plane_distance / slope);
        const Vec<T> w = ray.origin + t * ray.direction - triangle.a;
        const T d00 = dot(e0, e0), d01 = dot(e0, e1), d02 = dot(e0, w), d11 = dot(e1, e1), d12 = dot(e1, w);
        const T inverse = named("1/det", T(1) / (d00 * d11 - d01 * d01));
        const T c = named("c", (d00 * d12 - d01 * d02) * inverse), b = named("b", (d11 * d02 - d01 * d12) * inverse);
        const T a = named("a", T(1) - b - c);
        const auto in_range = [&](const T& x) { return x > -tolerance && x < T(1) + tolerance; };
        return single_hit<T>(abs(slope) > tolerance && in_range(a) && in_range(b) && in_range(c) && t >= zero, t);
    }
};

}  // namespace lostbits::intersect::triangle
