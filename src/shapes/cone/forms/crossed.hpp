// The quadric from squares of vectors across the axis, which are computed as cross products. For lines near the axis,
// no digits are lost if the cone is far away.
#pragma once

#include "shapes/cone/forms/parts.hpp"

namespace lostbits::intersect::cone {

struct CrossedCone {
    static constexpr Info info{
        .name = "cone.crossed",
        .title = "quadric from cross products with the axis",
        .source = "as Cychosz and Waggenspack have it of cylinders, Graphics Gems IV (1994)",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base;
        const Vec<T> m = cross(v, f), n = cross(v, ray.direction);
        const T v_dot_f = named("v.f", dot(v, f)), axis_rate = named("v.d", dot(v, ray.direction)), v2 = square(v);
        const T s = cone.top_radius - cone.base_radius;
        const T rho = named("rho", cone.base_radius * v2 + s * v_dot_f), sigma = named("sigma", s * axis_rate);
        const T a = named("a", v2 * square(n) - square(sigma)), h = named("h", v2 * dot(m, n) - rho * sigma);
        const T c = named("c", v2 * square(m) - square(rho)), disc = named("disc", square(h) - a * c);
        return find_first_of_side_and_caps<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)),
                                              caps_without_division<T>(cone, ray, v_dot_f, axis_rate));
    }
};

}  // namespace lostbits::intersect::cone
