// Normalises the axis, then takes dot products with it. O leads from the tube's bottom to the ray origin, Oz is its
// part along the axis, and C is O·O − Oz² − r². The squares O·O and Oz² grow with the distance of the origin from the
// tube, and so does the rounding error of C.
#pragma once

#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct UnitAxisTube {
    static constexpr Info info{
        .name = "tube.unit_axis",
        .title = "dot products with the normalised axis",
        .source = "Embree, kernels/geometry/cylinder.h, Cylinder::intersect, cut off at both ends",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const Vec<T> axis = tube.top - tube.bottom, o = ray.origin - tube.bottom;
        const Vec<T>& d = ray.direction;
        const T height = named("height", length(axis));
        const Vec<T> v(axis.x / height, axis.y / height, axis.z / height);
        const T oz = named("Oz", dot(o, v)), dz = named("dz", dot(d, v));
        const T a = named("A", square(d) - square(dz)), b = named("B", dot(o, d) - oz * dz);
        const T c = named("C", square(o) - square(oz) - square(tube.radius)), disc = named("D", square(b) - a * c);
        return find_first_between_ends<T>(disc < T(0), plain_half_roots<T>(a, b, sqrt(disc)), oz, dz, height);
    }
};

}  // namespace lostbits::intersect::tube
