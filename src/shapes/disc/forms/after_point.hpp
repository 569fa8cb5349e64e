// Computes the point on the plane in world space first, and then its distance from the centre.
#pragma once

#include "shapes/disc/forms/parts.hpp"

namespace lostbits::intersect::disc {

struct AfterPointDisc {
    static constexpr Info info{
        .name = "disc.after_point",
        .title = "the point in world space, then minus the centre",
        .source = "Blender Cycles, intern/cycles/util/math_intersect.h, ray_disk_intersect",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Disc<T>& disc) {
        const T numerator = named("n.(c-o)", dot(disc.centre - ray.origin, disc.normal));
        const T t = named("t", numerator / named("n.d", dot(ray.direction, disc.normal)));
        const Vec<T> p = ray.origin + t * ray.direction;
        return hit_between_rims<T>(t, named("p^2", square(Vec<T>(p - disc.centre))), disc);
    }
};

}  // namespace lostbits::intersect::disc
