// `signs` with each far plane's t times 1 + 2γ(3). The three roundings of (second − o)·inv and the three of the near
// plane's t then cannot separate a near and a far plane that meet. The end of the ray is not padded.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct PbrtPadded {
    static constexpr Info info{
        .name = "box.pbrt_padded",
        .title = "signs, far planes padded by 2 gamma(3)",
        .source = "Pharr, Jakob, Humphreys, pbrt-v4, sections 6.1.2 and 6.8.2; Ize 2013",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        const T padding = T(1) + T(2) * gamma_bound<T>(3);
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const Planes<T> planes = planes_by_sign<T>(box, axis, inv);
            const T dmin = named("dmin", (planes.first - ray.origin[axis]) * inv);
            const T dmax = named("dmax", (planes.second - ray.origin[axis]) * inv * padding);
            tmin = named("tmin", max(dmin, tmin));
            tmax = named("tmax", min(dmax, tmax));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
