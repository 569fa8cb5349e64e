// The cone as an instance along z: the ray is transformed into a frame made from the axis. There the cone is x² + y² =
// (r + s z)², with the caps z = 0 and z = height. The rounding of the frame's axes changes the shape.
#pragma once

#include "shapes/cone/forms/parts.hpp"
#include "shapes/cylinder/forms/axis_frame.hpp"

namespace lostbits::intersect::cone {

struct FramedCone {
    static constexpr Info info{
        .name = "cone.framed",
        .title = "transformed into a frame along the axis",
        .source = "pbrt-v3, src/shapes/cone.cpp, with CoordinateSystem (Duff et al. 2017) as its transform",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cone<T>& cone) {
        const cylinder::AxisFrame<T> frame(cone.top - cone.base);
        const Vec<T> o = frame.to_frame(ray.origin - cone.base), d = frame.to_frame(ray.direction);
        const T s = named("s", (cone.top_radius - cone.base_radius) / frame.height);
        const T r = named("r", cone.base_radius + s * o.z), k = named("k", s * d.z);
        const T a = named("a", square(d.x) + square(d.y) - square(k));
        const T h = named("h", o.x * d.x + o.y * d.y - r * k);
        const T c = named("c", square(o.x) + square(o.y) - square(r));
        const T disc = named("disc", square(h) - a * c), t_base = -o.z / d.z, t_top = (frame.height - o.z) / d.z;
        const auto is_within = [&](const T& t, const T& radius) {
            return square(o.x + t * d.x) + square(o.y + t * d.y) <= square(radius);
        };
        const CapCrossings<T> caps{t_base, t_top, is_within(t_base, cone.base_radius),
                                   is_within(t_top, cone.top_radius)};
        return find_first_of_side_and_caps<T>(disc < T(0), plain_half_roots<T>(a, h, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cone
