// Havel and Herout's three planes, computed once for each triangle, and one division after the tests. The tests compare
// sign bits, so zeros count as positive: if a ray comes from behind, points on the edges are not hit.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct HavelHerout {
    static constexpr Info info{
        .name = "triangle.havel_herout",
        .title = "three planes for each triangle, signs compared",
        .source = "Havel and Herout, IEEE TVCG 16(3), 2010; edges met from behind are left out",
        .roots = Roots::first_only,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a, n0 = cross(e1, e2);
        const T d0 = named("d0", dot(n0, triangle.a)), inverse = T(1) / dot(n0, n0);
        const Vec<T> n1 = inverse * cross(e2, n0), n2 = inverse * cross(n0, e1);
        const T d1 = named("d1", -dot(n1, triangle.a)), d2 = named("d2", -dot(n2, triangle.a));

        const T det = named("det", dot(n0, ray.direction)), dett = named("dett", d0 - dot(ray.origin, n0));
        const Vec<T> p = det * ray.origin + dett * ray.direction;
        const T u = named("detu", dot(p, n1) + det * d1), v = named("detv", dot(p, n2) + det * d2);
        const T w = named("detw", det - u - v), rdet = named("rdet", T(1) / det), t = named("t", dett * rdet);
        named("u", u * rdet);
        named("v", v * rdet);
        const mask_t<T> are_none_negative = !(u < T(0)) && !(v < T(0)) && !(w < T(0)),
                        are_all_negative = u < T(0) && v < T(0) && w < T(0);
        return single_hit<T>((are_none_negative || are_all_negative) && is_not_zero(det) && t >= T(0), t);
    }
};

}  // namespace lostbits::intersect::triangle
