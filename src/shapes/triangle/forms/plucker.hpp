// Plücker's test with plain signs: a hit if no two of the three signs are opposite.
#pragma once

#include "shapes/triangle/forms/plucker_edges.hpp"

namespace lostbits::intersect::triangle {

struct Plucker {
    static constexpr Info info{
        .name = "triangle.plucker",
        .title = "Plücker edge tests by their signs",
        .source = "Blender Cycles 2.79, intern/cycles/util/util_math_intersect.h, ray_triangle_intersect",
        .roots = Roots::first_only,
        .weights = {"u", "v", ""},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const PluckerEdges<T> edges(ray, triangle.c, triangle.a, triangle.b);
        const Vec<T> n1 = cross(edges.e1, edges.e0), n = n1 + n1;
        const T den = named("den", dot(n, ray.direction)), tn = named("T", dot(edges.v0, n));
        const T inverse = named("1/den", T(1) / den), t = named("t", tn * inverse);
        // The source has (y + x) × (y − x).
        named("u", -edges.u * inverse);
        named("v", -edges.v * inverse);
        const mask_t<T> is_inside = !(edges.least < T(0) && edges.greatest > T(0));
        return single_hit<T>(is_inside && is_not_zero(den) && !(select(den < T(0), -tn, tn) < T(0)), t);
    }
};

}  // namespace lostbits::intersect::triangle
