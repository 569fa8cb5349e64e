// The textbook: the quartic in t from the ray's origin without its cubic term, a resolvent cubic, two quadratics.
#pragma once

#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct GraphicsGems {
    static constexpr Info info{
        .name = "torus.graphics_gems",
        .title = "quartic in t, resolvent cubic, two quadratics",
        .source =
            "Schwarze, Cubic and Quartic Roots, Graphics Gems (1990), Roots3And4.c; as in bsf, BsTorus.cpp, 11-47",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const AlongAxis<T> in(ray, torus);
        First<T> first;
        quartic_roots<T>(quartic_in_t<T>(in.p, in.d, in.pz, in.dz, torus),
                         [&](const auto& is, const T& t) { first.take(is, t); });
        return first.answer();
    }
};

}  // namespace lostbits::intersect::torus
