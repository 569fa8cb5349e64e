// The open box: tmin = max(tmin, min(min(t1, t2), tmax)), tmax = min(tmax, max(max(t1, t2), tmin)) with the new tmin, a
// hit if tmin < tmax. If t1 or t2 is NaN, tmin = tmax after that axis, for either sign of d = ±0.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct Exclusive {
    static constexpr Info info{
        .name = "box.exclusive",
        .title = "slabs, a NaN leaves nothing: open box",
        .source = "Barnes, Fast, Branchless Ray/Bounding Box Intersections, part 2, as recalled in part 3",
        .touching = Touching::miss,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) * inv);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) * inv);
            tmin = named("tmin", max(tmin, min(min(t1, t2), tmax)));
            tmax = named("tmax", min(tmax, max(max(t1, t2), tmin)));
        }
        return hit_from_segment<T>(tmin < tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
