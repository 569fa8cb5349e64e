// The box test of tinybvh. It has no padding, and 1/d of a component with |d| ≤ 10⁻¹² is ±10³⁰, so 0·∞ cannot occur.
// For a ray in the plane of a face, the t of this plane is 0. If that is the far plane, the ray leaves the slab at t =
// 0 and misses a box ahead of it. A ray in a box without thickness always misses it. A hit at the end of the ray does
// not count. tinybvh's answer may be behind the origin; here it is clipped at the origin.
#pragma once

#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {

struct TinyBvh {
    static constexpr Info info{
        .name = "box.tinybvh",
        .title = "slabs, reciprocals of zero directions 1e30",
        .source = "tinybvh, tiny_bvh.h:442 tinybvh_safercp, :711 tinybvh_intersect_aabb",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Box<T>& box, const T& limit) {
        const T billion = T(1000000000), least = T(1) / (T(1000000) * T(1000000));
        const T far = billion * billion * billion * T(1000);
        T tmin = -far, tmax = far;
        for (int axis = 0; axis < 3; ++axis) {
            const T d = ray.direction[axis];
            const T inv = named("rD", select(abs(d) > least, T(1) / d, select(d >= T(0), far, -far)));
            const T t1 = named("t1", (box.lo[axis] - ray.origin[axis]) * inv);
            const T t2 = named("t2", (box.hi[axis] - ray.origin[axis]) * inv);
            tmin = named("tmin", max(tmin, min(t1, t2)));
            tmax = named("tmax", min(tmax, max(t1, t2)));
        }
        return hit_from_segment<T>(tmax >= tmin && tmin < limit && tmax >= T(0), {max(tmin, T(0)), min(tmax, limit)});
    }
};

}  // namespace lostbits::intersect::box
