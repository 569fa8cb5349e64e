// Embree's sphere points: rd2 = 1/a, t_c = ((G − O)·d) rd2, perp = (G − O) − t_c d, t = t_c ∓ √((r² − perp·perp) rd2),
// a hit where perp·perp ≤ r².
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct EmbreePoint {
    static constexpr Info info{
        .name = "sphere.embree_point",
        .title = "Embree sphere points",
        .source = "Embree, kernels/geometry/spherei_intersector.h; Cycles",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> g = sphere.centre - ray.origin;
        const T rd2 = named("rd2", T(1) / square(ray.direction));
        const T tc = named("tc", dot(g, ray.direction) * rd2);
        const Vec<T> perp = g - tc * ray.direction;
        const T l2 = named("l2", square(perp));
        const T r2 = square(sphere.radius);
        const T td = named("td", sqrt((r2 - l2) * rd2));
        return hit_unless<T>(!(l2 <= r2), RootPair<T>{tc - td, tc + td});
    }
};

}  // namespace lostbits::intersect::sphere
