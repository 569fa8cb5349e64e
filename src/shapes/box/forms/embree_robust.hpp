// Embree's former robust traversal (`embree_padded` replaced it): `signs`, then a hit where (1 − 3ε) tmin ≤ (1 + 3ε)
// tmax with ε = 2u, which is 2⁻²³ in float. Only the comparison is padded: t is the unpadded tmin, as Embree's
// distance is. The end of the ray is part of tmax, so it is padded too.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct EmbreeRobust {
    static constexpr Info info{
        .name = "box.embree_robust",
        .title = "signs, both sides padded by 3 eps",
        .source = "Embree 2, kernels/bvh/node_intersector1.h, robust mode, until a7a3bde31 of 2017",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        T tmin(0), tmax = limit;
        clip_by_signs(ray, box, tmin, tmax);
        const T three_eps = T(3) * (T(2) * unit_roundoff<T>());
        const T down = T(1) - three_eps, up = T(1) + three_eps;
        return hit_from_segment<T>(down * tmin <= up * tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
