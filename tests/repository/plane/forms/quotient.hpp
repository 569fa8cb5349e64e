// t = n·(P − o)/(n·d), as everyone writes it.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct Quotient {
    static constexpr Info info{
        .name = "plane.quotient",
        .title = "one quotient of two scalar products",
        .source = "an example of a shape",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        const T n = named("n.(P-o)", dot(plane.normal, plane.point - ray.origin));
        const T m = named("n.d", dot(plane.normal, ray.direction));
        const T t = named("t", n / m);
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
