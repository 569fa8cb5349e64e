// `signs` with the last tmax times 1 + 2⁻²², two units in the last place of a float's 1. That is 4u, and the six
// roundings of a near and a far plane that meet can separate them by 6u, so a rare ray still slips through. The factor
// is a constant of the form, the same in every format: no padding where it rounds to 1, 2³⁰ last places in binary64,
// and a larger box in exact arithmetic.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct MaxMult {
    static constexpr Info info{
        .name = "box.max_mult",
        .title = "signs, tmax times 1 + 2^-22",
        .source = "Ize, Robust BVH Ray Traversal, JCGT 2(2), 2013",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        T tmin(0), tmax = limit;
        clip_by_signs(ray, box, tmin, tmax);
        tmax = named("tmax", tmax * (T(1) + T(1) / T(4194304)));  // 4194304 = 2²²
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
