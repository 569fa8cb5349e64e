// t = n·(P − o)/(n·d), as it is usually written, and 0 from inside, where n·(P − o) ≥ 0.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/half_space/half_space.hpp"

namespace lostbits::intersect::half_space {

struct Quotient {
    static constexpr Info info{
        .name = "half_space.quotient",
        .title = "one quotient of two scalar products",
        .source = "an example of a shape",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const HalfSpace<T>& half) {
        const T n = named("n.(P-o)", dot(half.normal, half.point - ray.origin));
        const T m = named("n.d", dot(half.normal, ray.direction));
        const T t = named("t", select(n >= T(0), T(0), n / m));
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::half_space
