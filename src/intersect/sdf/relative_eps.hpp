// Sphere tracing with a threshold that grows with the distance, like the rounding error of o + t·dir.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// A hit if d < relative_eps·t. Uses relative_eps, max_dist, max_steps.
struct RelativeEps {
    static constexpr Info info{.name = "sdf.relative_eps",
                               .title = "hit where the field is below relative_eps t",
                               .source = "common in shaders; after SDF Sphere Marching (lesson P0-C1)",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const auto m =
            march(ray, field, constants, watch, [&](const T& d, const T& t) { return d < constants.relative_eps * t; });
        return single_hit(m.hit, m.t);
    }
};

}  // namespace lostbits::intersect::sdf
