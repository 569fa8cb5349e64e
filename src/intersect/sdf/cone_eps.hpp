// Sphere tracing that stops when the surface comes within the cone of a pixel.
#pragma once

#include "intersect/sdf/march_loop.hpp"

namespace lostbits::intersect::sdf {

/// A hit if d < cone·t. The answer is the t of the previous sample, which was outside the cone. Uses cone, max_dist,
/// max_steps.
struct ConeEps {
    static constexpr Info info{.name = "sdf.cone_eps",
                               .title = "hit where the field is below cone t; the point before it",
                               .source = "Hart 1996, cone tracing",
                               .direction = Direction::unit,
                               .roots = Roots::first_only};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch) {
        const auto m =
            march(ray, field, constants, watch, [&](const T& d, const T& t) { return d < constants.cone * t; });
        return single_hit(m.hit, select(m.hit, m.t_before, m.t));
    }
};

}  // namespace lostbits::intersect::sdf
