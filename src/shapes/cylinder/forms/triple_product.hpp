// Decides by the shortest distance between line and axis: disc = v² (r² n² − (f·n)²), n = v × d. The discriminant
// subtracts the square of a determinant, and not the square of the distance to the cylinder. The roots subtract no
// numbers of similar size.
#pragma once

#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct TripleProductCylinder {
    static constexpr Info info{
        .name = "cylinder.triple_product",
        .title = "distance between line and axis, stable roots",
        .source =
            "Shene, Computing the Intersection of a Line and a Cylinder, Graphics Gems IV (1994), with stable roots",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const Vec<T> v = cylinder.top - cylinder.base, f = ray.origin - cylinder.base;
        const Vec<T> n = cross(v, ray.direction), m = cross(v, f);
        const T a = named("a", square(n)), minus_h = named("h'", -dot(m, n)), v2 = square(v);
        const T r2 = square(cylinder.radius), w = named("w", dot(f, n));
        const T disc = named("disc", v2 * (r2 * a - square(w)));
        const T c = named("c", square(m) - r2 * v2);
        const T v_dot_f = named("v.f", dot(v, f)), axis_rate = named("v.d", dot(v, ray.direction));
        const RootPair<T> caps = order_caps<T>(-v_dot_f / axis_rate, (v2 - v_dot_f) / axis_rate);
        return find_first_of_side_and_caps<T>(a, c, disc, unified_roots<T>(a, minus_h, c, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cylinder
