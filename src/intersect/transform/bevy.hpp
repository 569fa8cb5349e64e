// Bevy's ray cast at a mesh: the direction is normalised in the space of the mesh. The vector along it to the hit point
// is converted back to the world, and the length of that vector is t.
#pragma once

#include "intersect/transform/cycles.hpp"

namespace lostbits::intersect::transform {

struct BevyTransform : CyclesTransform {
    static constexpr TransformMethodInfo info{
        .name = "bevy",
        .title = "M^-1 o and M^-1 d made unit; t is the length of M applied to t d'",
        .source = "Bevy, crates/bevy_picking/src/mesh_picking/ray_cast/intersections.rs ray_mesh_intersection",
        .direction = Direction::unit,
        .normalises = true,
    };

    template <Number T>
    static T back(const MatrixPair<T>& matrices, const Ray<T>&, const ObjectRay<T>& object_ray, const T& t) {
        return named("|M t d'|", length(matrices.to_world.linear(named("t d'", Vec<T>(t * object_ray.ray.direction)))));
    }
};

}  // namespace lostbits::intersect::transform
