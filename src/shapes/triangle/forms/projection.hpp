// Wald's projection: the plane first, then two barycentric coordinates in the plane of two axes, from numbers that are
// computed once for each triangle.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct Projection {
    static constexpr Info info{
        .name = "triangle.projection",
        .title = "the plane, then two coordinates along two axes",
        .source = "Wald, thesis, 2004; Mitsuba 08b1861, include/mitsuba/render/triaccel.h:47",
        .roots = Roots::first_only,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> to_c = triangle.c - triangle.a, to_b = triangle.b - triangle.a, normal = cross(to_b, to_c);
        const LargestComponent<T> axis(absolute_values(normal));
        const Vec<T> n = axis.rotate_to_last(normal), b = axis.rotate_to_last(to_c), c = axis.rotate_to_last(to_b),
                     a = axis.rotate_to_last(triangle.a);
        const T denom = named("denom", b.x * c.y - b.y * c.x);
        const T nu = n.x / n.z, nv = n.y / n.z, nd = named("n_d", dot(triangle.a, normal) / n.z);
        const T bu = b.x / denom, bv = -b.y / denom, cu = c.y / denom, cv = -c.x / denom;

        const Vec<T> o = axis.rotate_to_last(ray.origin), d = axis.rotate_to_last(ray.direction);
        const T plane_distance = named("from", nd - o.x * nu - o.y * nv - o.z),
                slope = named("along", d.x * nu + d.y * nv + d.z);
        const T t = named("t", plane_distance / slope), hu = o.x + t * d.x - a.x, hv = o.y + t * d.y - a.y;
        const T u = named("u", hv * bu + hu * bv), v = named("v", hu * cu + hv * cv);
        return single_hit<T>(!(t < T(0)) && u >= T(0) && v >= T(0) && u + v <= T(1), t);
    }
};

}  // namespace lostbits::intersect::triangle
