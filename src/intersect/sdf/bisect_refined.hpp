// Sphere tracing, then bisection between the last sample outside the surface and a point inside.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// After the hit of `sphere_trace`, looks for a point inside at hit_eps, 2 hit_eps, … behind the hit, `max_doublings`
/// times, so up to 2^7 hit_eps. Then it halves the interval bisect_steps times and returns its middle. If no point
/// inside is found (a ray that meets the surface at a cosine below 2^-7), t is not changed. Uses hit_eps, max_dist,
/// max_steps, bisect_steps.
struct BisectRefined {
    static constexpr Info info{.name = "sdf.bisect_refined",
                               .title = "sphere_trace, then bisection to the root of the field",
                               .source = "bisection",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        constexpr int max_doublings = 8;
        const T zero(0), two(2);
        const auto m = march(ray, field, constants, watch, [&](const T& d, const T&) { return d < constants.hit_eps; });
        auto is_inside = m.hit && m.d < zero;  // the last step already went through the surface
        T low = select(is_inside, m.t_before, m.t);
        T high = m.t;
        T distance = constants.hit_eps;

        // Steps further along the ray until a point lies inside.
        for (int i = 0; i < max_doublings && any_of(m.hit && !is_inside); ++i) {
            const auto is_outside = m.hit && !is_inside;
            high = select(is_outside, m.t + distance, high);
            is_inside = is_inside || (is_outside && field(point_on_ray(ray, high)) < zero);
            distance = distance + distance;
        }

        // Halves the interval between the last point outside and that point.
        for (int i = 0; i < constants.bisect_steps && any_of(is_inside); ++i) {
            const T middle = (low + high) / two;
            const auto is_beyond = field(point_on_ray(ray, middle)) < zero;
            high = select(is_beyond, middle, high);
            low = select(is_beyond, low, middle);
        }
        return single_hit(m.hit, select(is_inside, (low + high) / two, m.t));
    }
};

}  // namespace lostbits::intersect::sdf
