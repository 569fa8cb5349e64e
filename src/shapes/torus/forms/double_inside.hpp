// Float in, the textbook quartic in double, float out: what renderers with a double solver do.
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

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        using W = typename Wider<T>::type;
        const auto widen = [](const Vec<T>& v) {
            return Vec<W>(Wider<T>::widen(v.x), Wider<T>::widen(v.y), Wider<T>::widen(v.z));
        };
        const Hit<W> wide =
            GraphicsGems::intersect<W>({widen(ray.origin), widen(ray.direction)},
                                       {widen(torus.centre), widen(torus.axis), Wider<T>::widen(torus.major_radius),
                                        Wider<T>::widen(torus.minor_radius)});
        return {wide.hit, Wider<T>::narrow(wide.t), Wider<T>::narrow(wide.near), Wider<T>::narrow(wide.far)};
    }
};

}  // namespace lostbits::intersect::torus
