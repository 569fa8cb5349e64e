// The quadratic divided by a = 1 − dz², for a direction of length one. If the line is nearly parallel to the axis, so
// that a is below 1e-10, the form finds no root.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct CeleritasTube {
    static constexpr Info info{
        .name = "tube.celeritas",
        .title = "divided by a = 1 - dz^2, none below 1e-10",
        .source = "Celeritas, src/orange/surf/detail/QuadraticSolver.hh and CylAligned.hh, cut off at both ends",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const T a = named("a", T(1) - square(d.z)), least = T(1) / (T(100000) * T(100000));
        const T half_b = named("half_b", (o.x * d.x + o.y * d.y) / a);
        const T c = named("c", (square(o.x) + square(o.y) - square(tube.radius)) / a);
        const T disc = named("b2_4", square(half_b) - c), root = sqrt(disc);
        return find_first_between_ends<T>(disc < T(0) || a < least, {-half_b - root, -half_b + root}, o.z, d.z,
                                          frame.height);
    }
};

}  // namespace lostbits::intersect::tube
