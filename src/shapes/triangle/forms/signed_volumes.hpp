// The signed volumes of the tetrahedra that the ray forms with the edges, as determinants of points relative to the
// origin. t is the volume between the triangle and the origin, divided by the sum of the three.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct SignedVolumes {
    static constexpr Info info{
        .name = "triangle.signed_volumes",
        .title = "signs of three determinants, t as a fourth",
        .source = "Segura and Feito, WSCG 2001; Ericson, Real-Time Collision Detection, section 5.3.4",
        .roots = Roots::first_only,
        .weights = {"u", "v", "w"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const Vec<T> a = triangle.a - ray.origin, b = triangle.b - ray.origin, c = triangle.c - ray.origin;
        const Vec<T> bc = cross(b, c);
        const T u = named("U", dot(ray.direction, bc)), v = named("V", dot(ray.direction, cross(c, a)));
        const T w = named("W", dot(ray.direction, cross(a, b))), zero(0), sum = named("U+V+W", u + v + w);
        const T t = named("t", named("volume", dot(a, bc)) / sum), denom = named("denom", T(1) / sum);
        named("u", u * denom);
        named("v", v * denom);
        named("w", w * denom);
        const mask_t<T> is_inside = (u >= zero && v >= zero && w >= zero) || (u <= zero && v <= zero && w <= zero);
        return single_hit<T>(is_inside && is_not_zero(sum) && t >= zero, t);
    }
};

}  // namespace lostbits::intersect::triangle
