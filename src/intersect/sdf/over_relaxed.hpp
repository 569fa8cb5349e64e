// Sphere tracing with steps longer than the field value. A step that turns out to be too long is undone.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// Each step is ω·d. If the sphere around the new point does not reach the sphere around the last one (|d| + |d_last| <
/// step), a surface may lie between them. Then the step is replaced by the safe one, to t_last + d_last, and ω is 1 for
/// the rest of the march. A hit needs d < hit_eps after a step that is not undone. Uses over_relaxation, hit_eps,
/// max_dist, max_steps.
struct OverRelaxed {
    static constexpr Info info{.name = "sdf.over_relaxed",
                               .title = "steps of omega d, undone if the spheres do not touch",
                               .source = "Keinert et al. 2014, enhanced sphere tracing",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const T zero(0), one(1);
        auto active = zero <= zero;
        auto hit = !active;
        T t = zero, omega = constants.over_relaxation;
        T t_last = zero, d_last = zero, step = zero;
        for (int i = 0; i < constants.max_steps && any_of(active); ++i) {
            const Vec<T> p = point_on_ray(ray, t);
            const T d = field(p);
            watch(active, t, p, d);

            const auto is_undone = omega > one && abs(d) + abs(d_last) < step;
            hit = hit || (active && !is_undone && d < constants.hit_eps);
            active = active && !hit;

            // Moves to the next point, or back to the safe step.
            omega = select(is_undone, one, omega);
            step = select(is_undone, zero, omega * d);
            const T next = select(is_undone, t_last + d_last, t + step);
            t_last = select(active && !is_undone, t, t_last);
            d_last = select(active && !is_undone, d, d_last);
            t = select(active, next, t);

            watch.on_step(active, t, is_undone);
            active = active && !(t > constants.max_dist);
        }
        return single_hit(hit, t);
    }
};

}  // namespace lostbits::intersect::sdf
