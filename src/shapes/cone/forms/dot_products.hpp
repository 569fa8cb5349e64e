// The quadric (distance of p from the axis)² = (radius at p)² from dot products with the axis, with h = b/2. The square
// of v × f is computed as v²f² − (v·f)²; a and h are computed in the same way.
#pragma once

#include "shapes/cone/forms/parts.hpp"

namespace lostbits::intersect::cone {

struct DotProductsCone {
    static constexpr Info info{
        .name = "cone.dot_products",
        .title = "quadric from dot products with the axis",
        .source = "Eberly, Intersection of a Line and a Cone (2000), with a radius at both ends",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const Vec<T>& d = ray.direction;
        const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base;
        const T v_dot_f = named("v.f", dot(v, f)), axis_rate = named("v.d", dot(v, d)), v2 = square(v);
        const T s = cone.top_radius - cone.base_radius;
        const T r = named("r", cone.base_radius + s * v_dot_f / v2), k = named("k", s * axis_rate / v2);
        const T a = named("a", square(d) - square(axis_rate) / v2 - square(k));
        const T h = named("h", dot(f, d) - v_dot_f * axis_rate / v2 - r * k);
        const T c = named("c", square(f) - square(v_dot_f) / v2 - square(r));
        const T disc = named("disc", square(h) - a * c);
        return find_first_of_side_and_caps<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)),
                                              caps_by_points<T>(cone, ray, v_dot_f, axis_rate, v2));
    }
};

}  // namespace lostbits::intersect::cone
