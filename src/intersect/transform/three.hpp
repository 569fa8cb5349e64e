// The ray cast of three.js at a mesh: the direction is normalised in the space of the mesh, and t is the distance of
// the hit point after it is converted back to the world.
#pragma once

#include "intersect/transform/cycles.hpp"

namespace lostbits::intersect::transform {

struct ThreeJsTransform : CyclesTransform {
    static constexpr TransformMethodInfo info{
        .name = "three",
        .title = "M^-1 o and M^-1 d made unit; t is the distance from o of M applied to the point",
        .source = "three.js, src/math/Ray.js applyMatrix4, src/objects/Mesh.js checkIntersection",
        .direction = Direction::unit,
        .normalises = true,
    };

    /// Normalises as three.js does: v.normalize() multiplies v by 1/|v|.
    template <Number T>
    static ObjectRay<T> finish(const Maps<T>&, const Vec<T>&, const Ray<T>& ray) {
        const T size = named("|d'|", length(ray.direction)), r = T(1) / size;
        return {{ray.origin, r * ray.direction}, size, T(1)};
    }
    template <Number T>
    static T back(const Maps<T>& m, const Ray<T>& world, const ObjectRay<T>& in, const T& t) {
        const Vec<T> point = named("P'", Vec<T>(in.ray.origin + t * in.ray.direction));
        return named("|P - o|", length(Vec<T>(named("P", m.to_world.point(point)) - world.origin)));
    }
};

}  // namespace lostbits::intersect::transform
