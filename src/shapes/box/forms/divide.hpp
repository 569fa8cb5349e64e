// `inclusive` with one rounding less for each plane: t1 = (lo − o)/d, t2 = (hi − o)/d. A ray in one of the planes
// makes 0/0, which is NaN like 0·∞. A d whose reciprocal overflows can still divide.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct Divide {
    static constexpr Info info{
        .name = "box.divide",
        .title = "inclusive slabs with true division",
        .source =
            "Barnes, Fast, Branchless Ray/Bounding Box Intersections, part 3: Boundaries, with t = (x - x0)/xd as "
            "written there",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) / ray.direction[axis]);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) / ray.direction[axis]);
            tmin = named("tmin", min(max(t1, tmin), max(t2, tmin)));
            tmax = named("tmax", max(min(t1, tmax), min(t2, tmax)));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
