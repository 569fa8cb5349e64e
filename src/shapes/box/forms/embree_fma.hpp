// Embree's fast traversal. A direction component with |d| < 10⁻¹⁸ becomes +10⁻¹⁸, whatever its sign, so that nothing
// divides by zero. t = fma(plane, inv, −(o·inv)), with the planes in the order of inv's sign bit. The subtraction
// plane − o, which is exact or nearly so for planes near o, is not made: o·inv is rounded before anything cancels.
// 10⁻¹⁸ is a constant of the form, the same in every format that can hold it. Where it underflows, zero directions
// stay zero.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct EmbreeFma {
    static constexpr Info info{
        .name = "box.embree_fma",
        .title = "fused multiply-add, zero directions nudged",
        .source = "Embree 3, kernels/bvh/node_intersector1.h and rcp_safe",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        const T tiny = T(1) / (T(1000000000) * T(1000000000));
        T tmin(0), tmax = limit;
        for (int axis = 0; axis < 3; ++axis) {
            const T d = ray.direction[axis];
            const T inv = named("inv", T(1) / select(abs(d) < tiny, tiny, d));
            const Planes<T> planes = planes_by_sign<T>(box, axis, inv);
            const T o_inv = named("o_inv", ray.origin[axis] * inv);
            tmin = named("tmin", max(fma(planes.first, inv, -o_inv), tmin));
            tmax = named("tmax", min(fma(planes.second, inv, -o_inv), tmax));
        }
        return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
    }
};

}  // namespace lostbits::intersect::box
