// The tube as an instance along z, with the moment o × d computed there: disc = r² (dx² + dy²) − (ox dy − oy dx)². The
// discriminant does not subtract the square of the distance to the tube, and the roots are stable.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct FramedMoment {
    static constexpr Info info{
        .name = "tube.framed_moment",
        .title = "transformed into a frame along the axis, moment, stable roots",
        .source = "this project: Lagrange's identity in the frame of pbrt's cylinder",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const T a = named("a", square(d.x) + square(d.y)), minus_h = named("h'", -(o.x * d.x + o.y * d.y));
        const T r2 = square(tube.radius), w = named("w", o.x * d.y - o.y * d.x);
        const T disc = named("disc", r2 * a - square(w)), c = named("c", square(o.x) + square(o.y) - r2);
        return find_first_between_ends<T>(disc < T(0), unified_roots<T>(a, minus_h, c, sqrt(disc)), o.z, d.z,
                                          frame.height);
    }
};

}  // namespace lostbits::intersect::tube
