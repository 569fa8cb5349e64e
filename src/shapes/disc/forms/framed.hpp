// The disc as an instance in the plane z = 0: the ray is transformed into a frame along the normal, and x² + y² is
// computed there.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/disc/forms/parts.hpp"

namespace lostbits::intersect::disc {

struct FramedDisc {
    static constexpr Info info{
        .name = "disc.framed",
        .title = "transformed into a frame along the normal",
        .source = "pbrt-v4, src/pbrt/shapes.h, Disk, with CoordinateSystem (Duff et al. 2017) as its transform",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Disc<T>& disc) {
        const cylinder::AxisFrame<T> frame(disc.normal);
        const Vec<T> o = frame.to_frame(ray.origin - disc.centre), d = frame.to_frame(ray.direction);
        const T t = named("t", -o.z / d.z);
        return hit_between_rims<T>(t, named("dist2", square(o.x + t * d.x) + square(o.y + t * d.y)), disc);
    }
};

}  // namespace lostbits::intersect::disc
