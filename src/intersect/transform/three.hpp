// The ray cast of three.js at a mesh: the direction is normalised in the space of the mesh. The hit point is converted
// back to the world, and its distance from the origin is t.
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
    static ObjectRay<T> finish(const MatrixPair<T>&, const Vec<T>&, const Ray<T>& ray) {
        const T length_of_d = named("|d'|", length(ray.direction)), r = T(1) / length_of_d;
        return {{ray.origin, r * ray.direction}, length_of_d, T(1)};
    }
    template <Number T>
    static T back(const MatrixPair<T>& matrices, const Ray<T>& world, const ObjectRay<T>& object_ray, const T& t) {
        const Vec<T> point = named("P'", Vec<T>(object_ray.ray.origin + t * object_ray.ray.direction));
        return named("|P - o|", length(Vec<T>(named("P", matrices.to_world.point(point)) - world.origin)));
    }
};

}  // namespace lostbits::intersect::transform
