// Misses if |n·d| or t is no more than 2^-23. |n·d| is a cosine if both vectors have length one; t is a length in the
// unit of the scene.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct EpsilonPlane {
    static constexpr Info info{
        .name = "plane.epsilon",
        .title = "misses if |n.d| or t is 2^-23 or less",
        .source = "bevy, crates/bevy_math/src/ray.rs, Ray3d::intersect_plane",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        const T epsilon = T(1) / T(1 << 23);  // f32::EPSILON in every format
        const T m = named("n.d", dot(plane.normal, ray.direction));
        const T t = named("t", dot(Vec<T>(plane.through - ray.origin), plane.normal) / m);
        return {abs(m) > epsilon && t > epsilon, t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
