// The textbook method: the quartic in t from the ray's origin, its cubic term removed, then a resolvent cubic and two
// quadratics.
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
        const TorusRay<T> relative(ray, torus);
        FirstHit<T> first_hit;
        take_quartic_roots<T>(quartic_in_t<T>(relative.p, relative.d, relative.pz, relative.dz, torus),
                              [&](const auto& is_root, const T& t) { first_hit.add_root(is_root, t); });
        return first_hit.answer();
    }
};

}  // namespace lostbits::intersect::torus
