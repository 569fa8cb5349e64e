// Sphere tracing, then secant steps from its last two samples.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// After the hit of `sphere_trace`, takes secant_steps steps to t − d·(t − t')/(d − d'). A step is kept only if it
/// makes |d| smaller: a ray that passes the surface within hit_eps without meeting it has no root. Uses hit_eps,
/// max_dist, max_steps, secant_steps.
struct SecantRefined {
    static constexpr Info info{.name = "sdf.secant_refined",
                               .title = "sphere_trace, then secant steps to the root of the field",
                               .source = "secant method",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const auto m = march(ray, field, constants, watch, [&](const T& d, const T&) { return d < constants.hit_eps; });
        T t = m.t, d = m.d, t_before = m.t_before, d_before = m.d_before;
        for (int i = 0; i < constants.secant_steps; ++i) {
            const auto is_falling = d_before > d;
            const T slope = select(is_falling, d_before - d, T(1));
            const T next = select(is_falling, t + d * ((t - t_before) / slope), t);
            const T d_next = field(point_on_ray(ray, next));
            const auto is_better = abs(d_next) < abs(d);
            t_before = select(is_better, t, t_before);
            d_before = select(is_better, d, d_before);
            t = select(is_better, next, t);
            d = select(is_better, d_next, d);
        }
        return single_hit(m.hit, t);
    }
};

}  // namespace lostbits::intersect::sdf
