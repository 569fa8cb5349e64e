// Baldwin and Weber's matrix from world to barycentric coordinates. It is computed once for each triangle, from rounded
// numbers that are as large as the coordinates of the triangle. Points on the edge from b to c are not hit; points on
// the other edges are.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct BaldwinWeber {
    static constexpr Info info{
        .name = "triangle.baldwin_weber",
        .title = "a matrix from world to barycentric coordinates",
        .source = "Baldwin and Weber, JCGT 5(3), 2016; the edge from b to c is left out, u + v < 1",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
        const LargestComponent<T> axis(absolute_values(normal));
        const Vec<T> a = axis.rotate_to_first(triangle.a), b = axis.rotate_to_first(triangle.b),
                     c = axis.rotate_to_first(triangle.c);
        const Vec<T> n = axis.rotate_to_first(normal), e1 = b - a, e2 = c - a;
        const Vec<T> o = axis.rotate_to_first(ray.origin), d = axis.rotate_to_first(ray.direction);
        const T x1 = b.y * a.z - b.z * a.y, x2 = c.y * a.z - c.z * a.y, num = dot(triangle.a, normal);

        const T my = n.y / n.x, mz = n.z / n.x, plane_offset = named("-num/n", -num / n.x);
        const T trans_s = named("transS", o.x + my * o.y + mz * o.z + plane_offset);
        const T trans_d = named("transD", d.x + my * d.y + mz * d.z);
        const T t = named("t", -trans_s / trans_d), wy = o.y + t * d.y, wz = o.z + t * d.z;
        const T u = named("u", (e2.z / n.x) * wy + (-e2.y / n.x) * wz + x2 / n.x);
        const T v = named("v", (-e1.z / n.x) * wy + (e1.y / n.x) * wz + -x1 / n.x);
        return single_hit<T>(t > T(0) && u >= T(0) && v >= T(0) && v + u < T(1), t);
    }
};

}  // namespace lostbits::intersect::triangle
