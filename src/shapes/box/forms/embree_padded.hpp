// Embree's robust traversal since version 3: it pads 1/d, and no longer the comparison. With ε = 2u, a near plane's t
// is (first − o)·fl((1 − 3ε)/d), and a far plane's t is (second − o)·fl((1 + 3ε)/d). A component with |d| < 10⁻¹⁸
// becomes +10⁻¹⁸. Each t has four roundings, which are less than its padding, so tmin is never too late and tmax never
// too early. The tmin that is compared with the end of the ray is padded too.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct EmbreePadded {
    static constexpr Info info{
        .name = "box.embree_padded",
        .title = "1/d padded by 3 eps either way, zero directions nudged",
        .source = "Embree 3 and 4, kernels/bvh/node_intersector1.h:103 TravRayBase<N,true>, :540 intersectNodeRobust",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        const T three_eps = T(3) * (T(2) * unit_roundoff<T>());
        const T tiny = T(1) / (T(1000000000) * T(1000000000));
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T d = ray.direction[axis];
            const T inv = named("inv", T(1) / select(abs(d) < tiny, tiny, d));
            const Planes<T> planes = planes_by_sign<T>(box, axis, inv);
            const T inv_near = named("inv_near", (T(1) - three_eps) * inv);
            const T inv_far = named("inv_far", (T(1) + three_eps) * inv);
            tmin = named("tmin", max((planes.first - ray.origin[axis]) * inv_near, tmin));
            tmax = named("tmax", min((planes.second - ray.origin[axis]) * inv_far, tmax));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
