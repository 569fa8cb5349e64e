// The slab method as first written: tmin = max(tmin, min(t1, t2)), tmax = min(tmax, max(t1, t2)), a hit if tmin < tmax.
// The inequality is strict, for the open box. A ray in one of the planes (d = ±0) makes 0·∞ = NaN. A NaN in t1 is
// dropped, and then no part of the ray is inside. A NaN in t2 becomes tmin and tmax, and the next axis replaces both,
// so the limits from earlier axes, from t ≥ 0 and from the end of the ray are lost.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct Baseline {
    static constexpr Info info{
        .name = "box.baseline",
        .title = "slabs, NaN not handled",
        .source = "Barnes, Fast, Branchless Ray/Bounding Box Intersections, part 1, as recalled in part 3",
        .touching = Touching::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) * inv);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) * inv);
            tmin = named("tmin", max(tmin, min(t1, t2)));
            tmax = named("tmax", min(tmax, max(t1, t2)));
        }
        return hit_from_segment<T>(tmin < tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
