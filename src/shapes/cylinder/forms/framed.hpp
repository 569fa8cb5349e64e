// The cylinder as an instance along z: the ray is transformed into a frame made from the axis. There the cylinder is x²
// + y² = r², with the caps z = 0 and z = height. The rounding of the frame's axes changes the shape.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct FramedCylinder {
    static constexpr Info info{
        .name = "cylinder.framed",
        .title = "transformed into a frame along the axis",
        .source = "pbrt-v4, src/pbrt/shapes.h, Cylinder, with CoordinateSystem (Duff et al. 2017) as its transform",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const AxisFrame<T> frame(cylinder.top - cylinder.base);
        const Vec<T> o = frame.to_frame(ray.origin - cylinder.base), d = frame.to_frame(ray.direction);
        const T qa = named("a", square(d.x) + square(d.y)), h = named("h", o.x * d.x + o.y * d.y);
        const T c = named("c", square(o.x) + square(o.y) - square(cylinder.radius));
        const T disc = named("disc", square(h) - qa * c);
        const RootPair<T> caps = order_caps<T>(-o.z / d.z, (frame.height - o.z) / d.z);
        return find_first_of_side_and_caps<T>(disc < T(0), plain_half_roots<T>(qa, h, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cylinder
