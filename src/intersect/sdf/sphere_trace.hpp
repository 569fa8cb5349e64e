// The march of SDF Sphere Marching (lesson P0-C1): each step is the field value, until the value is below an absolute
// threshold.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// A hit if d < hit_eps, at the t of that sample. The march stops before the surface, by up to hit_eps over the cosine
/// of the angle of incidence. Uses hit_eps, max_dist, max_steps.
struct SphereTrace {
    static constexpr Info info{.name = "sdf.sphere_trace",
                               .title = "hit where the field is below hit_eps",
                               .source = "SDF Sphere Marching (lesson P0-C1); Hart 1996",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const auto m = march(ray, field, constants, watch, [&](const T& d, const T&) { return d < constants.hit_eps; });
        return single_hit(m.hit, m.t);
    }
};

}  // namespace lostbits::intersect::sdf
