// `baseline` with IEEE's minNum and maxNum, which drop a NaN operand in either position: tmin = maxNum(tmin, minNum(t1,
// t2)), tmax = minNum(tmax, maxNum(t1, t2)), a hit if tmin ≤ tmax. For a ray in one of the planes, t of this plane is
// NaN from 0·∞, and t of the other plane is ±∞. So both minNum and maxNum are ±∞, and the ray misses in spite of the ≤,
// unless the box is flat on this axis and both t are NaN.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct IeeeMinmax {
    static constexpr Info info{
        .name = "box.ieee_minmax",
        .title = "slabs with IEEE minNum and maxNum",
        .source = "IEEE 754-2008, section 5.3.1; as GPU kernels write it with fmin and fmax",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) * inv);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) * inv);
            tmin = named("tmin", max_num<T>(tmin, min_num<T>(t1, t2)));
            tmax = named("tmax", min_num<T>(tmax, max_num<T>(t1, t2)));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
