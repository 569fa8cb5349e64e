// The tube as an instance along z: the ray is transformed into a frame made from the axis. There the tube is x² + y² =
// r², with z between the ends.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct FramedTube {
    static constexpr Info info{
        .name = "tube.framed",
        .title = "transformed into a frame along the axis",
        .source = "pbrt-v4, src/pbrt/shapes.h, Cylinder, with CoordinateSystem (Duff et al. 2017) as its transform",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const T a = named("a", square(d.x) + square(d.y)), h = named("h", o.x * d.x + o.y * d.y);
        const T c = named("c", square(o.x) + square(o.y) - square(tube.radius));
        const T disc = named("disc", square(h) - a * c);
        return find_first_between_ends<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)), o.z, d.z, frame.height);
    }
};

}  // namespace lostbits::intersect::tube
