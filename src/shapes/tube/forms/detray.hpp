// detray's cylinder: the coefficients are divided by a = dx² + dy² first, and the square of half b is added to (r² −
// ox² − oy²)/a. The roots are plain. If a < 2^-23, so that the direction is nearly along the axis, the form finds no
// root.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct DetrayTube {
    static constexpr Info info{
        .name = "tube.detray",
        .title = "divided by a at once, k^2 added, no line within an ulp of the axis",
        .source =
            "detray 7c3f18e, core/include/detray/navigation/intersection/soa/ray_cylinder_portal_intersector.hpp:75, "
            "cut off at both ends",
        .direction = Direction::unit,
        .roots = Roots::first_only,
        .formats = Formats::binary32_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const T a = named("rd_perp_2", square(d.x) + square(d.y)), over_a = T(1) / a;
        const T c = named("rad_diff", square(tube.radius) - (square(o.x) + square(o.y)));
        const T k = named("k", -over_a * (o.x * d.x + o.y * d.y));
        const T disc = named("discr", over_a * c + square(k)), root = sqrt(disc);
        return find_first_between_ends<T>(disc < T(0) || a < float_epsilon<T>(), {k - root, k + root}, o.z, d.z,
                                          frame.height);
    }

private:
    /// Returns std::numeric_limits<float>::epsilon(), 2^-23.
    template <Number T>
    static T float_epsilon() {
        return T(1) / (T(4096) * T(2048));
    }
};

}  // namespace lostbits::intersect::tube
