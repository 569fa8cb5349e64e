// The closed box: tmin = min(max(t1, tmin), max(t2, tmin)), tmax = max(min(t1, tmax), min(t2, tmax)), a hit where tmin
// ≤ tmax. With a NaN in t1 or t2, the inner max and min return tmin and tmax.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct Inclusive {
    static constexpr Info info{
        .name = "box.inclusive",
        .title = "slabs, a NaN changes nothing: closed box",
        .source = "Barnes, Fast, Branchless Ray/Bounding Box Intersections, part 3: Boundaries",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T inv = named("inv", T(1) / ray.direction[axis]);
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) * inv);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) * inv);
            tmin = named("tmin", min(max(t1, tmin), max(t2, tmin)));
            tmax = named("tmax", max(min(t1, tmax), min(t2, tmax)));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
