// Quilez: computes everything relative to the centre.
#pragma once

#include "shapes/disc/forms/parts.hpp"

namespace lostbits::intersect::disc {

struct QuilezDisc {
    static constexpr Info info{
        .name = "disc.quilez",
        .title = "the origin from the centre, then the point",
        .source = "Quilez, Intersectors, diskIntersect",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Disc<T>& disc) {
        const Vec<T> o = ray.origin - disc.centre;
        const T t = named("t", -named("n.o", dot(disc.normal, o)) / named("n.d", dot(ray.direction, disc.normal)));
        const Vec<T> q = o + t * ray.direction;
        return hit_between_rims<T>(t, named("q^2", square(q)), disc);
    }
};

}  // namespace lostbits::intersect::disc
