// The discriminant from the moment w = d × f, in which no length of f is squared: disc/v² = |ρn − σm|² − v⁴ (v·w)²
// with ρn − σm = v² (r n − s w) + s (v·w) v. The roots subtract no numbers of similar size, and the caps need no
// division.
#pragma once

#include "shapes/cone/forms/parts.hpp"

namespace lostbits::intersect::cone {

struct MomentCone {
    static constexpr Info info{
        .name = "cone.moment",
        .title = "discriminant from the moment d x f, stable roots",
        .source = "this project: Lagrange's identity twice, see Cone::span",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base;
        const Vec<T> m = cross(v, f), n = cross(v, ray.direction), w = cross(ray.direction, f);
        const T v_dot_f = named("v.f", dot(v, f)), axis_rate = named("v.d", dot(v, ray.direction)), v2 = square(v);
        const T s = cone.top_radius - cone.base_radius, vw = named("v.w", dot(v, w));
        const T rho = cone.base_radius * v2 + s * v_dot_f, sigma = s * axis_rate;
        const Vec<T> k = v2 * (cone.base_radius * n - s * w) + (s * vw) * v;
        const T a = named("a", v2 * square(n) - square(sigma));
        const T minus_h = named("h'", rho * sigma - v2 * dot(m, n)), c = named("c", v2 * square(m) - square(rho));
        const T disc = named("disc", v2 * (square(k) - square(v2 * vw)));
        return find_first_of_side_and_caps<T>(disc < T(0), unified_roots<T>(a, minus_h, c, sqrt(disc)),
                                              caps_without_division<T>(cone, ray, v_dot_f, axis_rate));
    }
};

}  // namespace lostbits::intersect::cone
