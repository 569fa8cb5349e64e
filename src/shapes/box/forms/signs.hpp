// The sign bit of 1/d says which plane comes first, so no min and max of t1 and t2 are needed: tmin = max(dmin, tmin),
// tmax = min(dmax, tmax), a hit if tmin ≤ tmax. (The source writes tmin < tmax when it introduces the form, and tmin ≤
// tmax in the batched code that it measures. This form follows the latter.)
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct Signs {
    static constexpr Info info{
        .name = "box.signs",
        .title = "slabs, planes chosen by the sign of 1/d",
        .source = "Barnes, Fast, Branchless Ray/Bounding Box Intersections, part 3: Boundaries, section Signs",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        T tmin(0), tmax = limit;
        clip_by_signs(ray, box, tmin, tmax);
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
