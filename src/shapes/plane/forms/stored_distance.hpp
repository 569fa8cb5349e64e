// The plane as n·p + w = 0. w = −n·P is computed once for all rays, and its rounding error grows with the distance of
// the plane's point P from the origin of the world.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct StoredDistance {
    static constexpr Info info{
        .name = "plane.stored_distance",
        .title = "-(n.o + w)/(n.d), w stored",
        .source = "Quilez, Intersectors, plaIntersect; three.js 0.185, src/math/Ray.js, distanceToPlane",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        const T w = named("w", -dot(plane.normal, plane.through));
        const T numerator = named("n.o+w", dot(plane.normal, ray.origin) + w);
        const T t = named("t", -(numerator / named("n.d", dot(plane.normal, ray.direction))));
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
