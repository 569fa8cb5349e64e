// The robust test of madmann91/bvh: `signs`, with 1/d of each far plane two units in the last place larger, after Ize.
// An infinite 1/d stays as it is. Two units are 2u to 4u of 1/d, and 2u if its significand is near 2. The six roundings
// of a near and a far plane that meet can separate them by 6u, so a rare ray still slips through.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct BvhRobust {
    static constexpr Info info{
        .name = "box.bvh_robust",
        .title = "signs, 1/d of far planes two last places larger",
        .source = "madmann91/bvh v2, src/bvh/v2/node.h:68 intersect_robust, ray.h:46 pad_inv_dir, utils.h:47",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const Planes<T> planes = planes_by_sign<T>(box, axis, inv);
            tmin = named("tmin", max((planes.first - ray.origin[axis]) * inv, tmin));
            tmax = named("tmax", min((planes.second - ray.origin[axis]) * pad<T>(inv), tmax));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }

private:
    template <Number T>
    static T pad(const T& inv) {
        return named("inv_pad", copysign(next_up(next_up(abs(inv))), inv));
    }
};

}  // namespace lostbits::intersect::box
