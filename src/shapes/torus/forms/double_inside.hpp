// Float in, the textbook quartic in double, float out, as in renderers with a double solver.
#pragma once

#include "shapes/torus/forms/graphics_gems.hpp"

namespace lostbits::intersect::torus {

struct TorusDoubleInside {
    static constexpr Info info{
        .name = "torus.double_inside",
        .title = "float in, textbook quartic in double, float out",
        .source = "Schwarze, Graphics Gems (1990), Roots3And4.c: its solver is in double",
        .direction = Direction::unit,
        .roots = Roots::first_only,
        .formats = Formats::binary32_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        return narrow_hit<T>(GraphicsGems::intersect(to_wider(ray), to_wider(torus)));
    }
};

}  // namespace lostbits::intersect::torus
