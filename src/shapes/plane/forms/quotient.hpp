// t = n·(P − o)/(n·d).
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct Quotient {
    static constexpr Info info{
        .name = "plane.quotient",
        .title = "one quotient of two dot products",
        .source = "Glassner, An Introduction to Ray Tracing (1989), chapter 2, from a point of the plane",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        const T numerator = named("n.(P-o)", dot(plane.normal, Vec<T>(plane.through - ray.origin)));
        const T t = named("t", numerator / named("n.d", dot(plane.normal, ray.direction)));
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
