// Mitsuba's cylinder: the ray is transformed to the cylinder in the renderer's format, which rounds, and the quadratic
// is solved in double.
#pragma once

#include "shapes/cylinder/forms/axis_frame.hpp"
#include "shapes/tube/forms/parts.hpp"

namespace lostbits::intersect::tube {

struct MitsubaTube {
    static constexpr Info info{
        .name = "tube.mitsuba",
        .title = "transformed into a frame in float, quadratic in double",
        .source = "Mitsuba 3, src/shapes/cylinder.cpp, ray_intersect_preliminary_impl, and solve_quadratic of math.h",
        .roots = Roots::first_only,
        .formats = Formats::binary32_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Tube<T>& tube) {
        using W = typename Wider<T>::type;
        const auto wide = [](const T& x) { return Wider<T>::widen(x); };
        const cylinder::AxisFrame<T> frame(tube.top - tube.bottom);
        const Vec<T> o = frame.to_frame(ray.origin - tube.bottom), d = frame.to_frame(ray.direction);
        const W ox = wide(o.x), oy = wide(o.y), dx = wide(d.x), dy = wide(d.y);
        const W a = named("A", square(dx) + square(dy)), b = named("B", W(2) * (dx * ox + dy * oy));
        const W c = named("C", square(ox) + square(oy) - square(wide(tube.radius)));
        const W disc = named("disc", square(b) - W(4) * a * c);
        const auto roots = press_roots<W>(a, b, c, sqrt(disc));
        const Hit<W> hit = find_first_between_ends<W>(disc < W(0), roots, wide(o.z), wide(d.z), wide(frame.height));
        const T t = Wider<T>::narrow(hit.t);
        return {hit.hit, t, t, t};
    }
};

}  // namespace lostbits::intersect::tube
