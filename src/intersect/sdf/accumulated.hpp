// Sphere tracing that moves the point itself, so that the rounding errors of all steps add up.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// p += d·dir in place of p = o + t·dir; both are the same in exact arithmetic. Uses hit_eps, max_dist, max_steps.
struct Accumulated {
    static constexpr Info info{.name = "sdf.accumulated",
                               .title = "p += d dir instead of o + t dir",
                               .source = "common in shaders; after SDF Sphere Marching (lesson P0-C1)",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const T zero(0);
        auto active = zero <= zero;
        auto hit = !active;
        T t = zero;
        Vec<T> p = ray.origin;
        for (int i = 0; i < constants.max_steps && any_of(active); ++i) {
            const T d = field(p);
            watch(active, t, p, d);
            hit = hit || (active && d < constants.hit_eps);
            active = active && !hit;
            const auto advanced = [&](const T& x, const T& direction) { return select(active, x + d * direction, x); };
            p = Vec<T>(advanced(p.x, ray.direction.x), advanced(p.y, ray.direction.y), advanced(p.z, ray.direction.z));
            t = select(active, t + d, t);
            watch.on_step(active, t, p);
            active = active && !(t > constants.max_dist);
        }
        return single_hit(hit, t);
    }
};

}  // namespace lostbits::intersect::sdf
