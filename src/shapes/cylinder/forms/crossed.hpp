// First the vectors across the axis, n = v × d and m = v × f, then a = n², h = m·n and c = m² − r²v². For lines near
// the axis, no digits are lost if the axis is long.
#pragma once

#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct CrossedCylinder {
    static constexpr Info info{
        .name = "cylinder.crossed",
        .title = "quadratic from cross products with the axis",
        .source = "Cychosz and Waggenspack, Intersecting a Ray with a Cylinder, Graphics Gems IV (1994)",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const Vec<T> v = cylinder.top - cylinder.base, f = ray.origin - cylinder.base;
        const Vec<T> n = cross(v, ray.direction), m = cross(v, f);
        const T a = named("a", square(n)), h = named("h", dot(m, n)), v2 = square(v);
        const T c = named("c", square(m) - square(cylinder.radius) * v2);
        const T disc = named("disc", square(h) - a * c);
        const T v_dot_f = named("v.f", dot(v, f)), axis_rate = named("v.d", dot(v, ray.direction));
        const RootPair<T> caps = order_caps<T>(-v_dot_f / axis_rate, (v2 - v_dot_f) / axis_rate);
        return find_first_of_side_and_caps<T>(a, c, disc, plain_half_roots<T>(a, h, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cylinder
