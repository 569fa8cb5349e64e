// `bracketed` in double, for floats. It starts from the closest approach, because the textbook's quartic is not
// accurate enough even in double.
#pragma once

#include "shapes/torus/forms/bracketed.hpp"

namespace lostbits::intersect::torus {

struct BracketedInDouble {
    static constexpr Info info{
        .name = "torus.bracketed_double",
        .title = "float in, closest approach and Sturm's chain in double",
        .source = "this project: see Torus::span and QuarticChain",
        .roots = Roots::first_only,
        .formats = Formats::binary32_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        return narrow_hit<T>(Bracketed::intersect(to_wider(ray), to_wider(torus)));
    }
};

}  // namespace lostbits::intersect::torus
