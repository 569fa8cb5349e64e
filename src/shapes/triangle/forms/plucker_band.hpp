// Plücker's test with a tolerance: a sign counts only if the value exceeds an ulp of the sum.
#pragma once

#include "shapes/triangle/forms/plucker_edges.hpp"

namespace lostbits::intersect::triangle {

struct PluckerBand {
    static constexpr Info info{
        .name = "triangle.plucker_band",
        .title = "Plücker edge tests, an ulp to spare",
        .source = "Embree 0d9493e, kernels/geometry/triangle_intersector_pluecker.h:80; rcp as 1/x",
        .roots = Roots::first_only,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const PluckerEdges<T> edges(ray, triangle.a, triangle.b, triangle.c);
        const T band = named("eps", T(2) * unit_roundoff<T>() * abs(edges.sum));
        const Vec<T> n = stable_normal(edges.e0, edges.e1, edges.e2);
        const T half_den = dot_from_z(n, ray.direction), den = named("den", half_den + half_den);
        const T tn = dot_from_z(edges.v0, n), t = named("t", (T(1) / den) * named("T", tn + tn));
        const T inverse = named("1/UVW", T(1) / edges.sum);
        named("u", edges.u * inverse);
        named("v", edges.v * inverse);
        return single_hit<T>((edges.least >= -band || edges.greatest <= band) && T(0) <= t && is_not_zero(den), t);
    }

private:
    /// Returns the normal. Each component is that of a × b or of b × c, which are equal without rounding: the one with
    /// the smaller products.
    template <Number T>
    static Vec<T> stable_normal(const Vec<T>& a, const Vec<T>& b, const Vec<T>& c) {
        const Vec<T> ab(a.z * b.y, a.x * b.z, a.y * b.x), bc(b.z * c.y, b.x * c.z, b.y * c.x);
        const Vec<T> cross_ab(a.y * b.z - ab.x, a.z * b.x - ab.y, a.x * b.y - ab.z);
        const Vec<T> cross_bc(b.y * c.z - bc.x, b.z * c.x - bc.y, b.x * c.y - bc.z);
        const auto part = [&](int i) { return select(abs(ab[i]) < abs(bc[i]), cross_ab[i], cross_bc[i]); };
        return Vec<T>(part(0), part(1), part(2));
    }
};

}  // namespace lostbits::intersect::triangle
