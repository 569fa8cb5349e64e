// Möller and Trumbore's determinants, compared with the first without a division, and divided by it at the end. The
// test of an edge that two triangles share may be U in one and U + V in the other.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct Undivided {
    static constexpr Info info{
        .name = "triangle.undivided",
        .title = "Möller-Trumbore, divided after the tests",
        .source = "Embree 008025c, kernels/geometry/triangle_intersector_moeller.h:81; rcp as 1/x",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"", "u", "v"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> e1 = triangle.a - triangle.b, e2 = triangle.c - triangle.a;
        const Vec<T> ng = cross(e2, e1), c = triangle.a - ray.origin, r = cross(c, ray.direction);
        const T den = named("den", dot_from_z(ng, ray.direction));
        const auto flip_if_back = [is_back = den < T(0)](const T& x) { return select(is_back, -x, x); };
        const T size = abs(den);
        const T u = named("U", flip_if_back(dot_from_z(r, e2))), v = named("V", flip_if_back(dot_from_z(r, e1)));
        const T tn = named("T", flip_if_back(dot_from_z(ng, c)));
        const T inverse = named("1/den", T(1) / size), t = named("t", tn * inverse);
        named("u", u * inverse);
        named("v", v * inverse);
        return single_hit<T>(is_not_zero(den) && u >= T(0) && v >= T(0) && u + v <= size && tn > T(0), t);
    }
};

}  // namespace lostbits::intersect::triangle
