// Decides by the shortest distance between line and axis, with stable roots: `cylinder.triple_product` without caps.
#pragma once

#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct TripleProductTube {
    static constexpr Info info{
        .name = "tube.triple_product",
        .title = "distance between line and axis, stable roots",
        .source =
            "Shene, Computing the Intersection of a Line and a Cylinder, Graphics Gems IV (1994), with stable roots",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const Vec<T> v = tube.top - tube.bottom, f = ray.origin - tube.bottom;
        const Vec<T> n = cross(v, ray.direction), m = cross(v, f);
        const T a = named("a", square(n)), minus_h = named("h'", -dot(m, n)), v2 = square(v);
        const T r2 = square(tube.radius), disc = named("disc", v2 * (r2 * a - square(named("w", dot(f, n)))));
        const T c = named("c", square(m) - r2 * v2);
        return find_first_between_ends<T>(disc < T(0), unified_roots<T>(a, minus_h, c, sqrt(disc)), dot(v, f),
                                          dot(v, ray.direction), v2);
    }
};

}  // namespace lostbits::intersect::tube
