// Bounding ball of a primitive in the world, in doubles. It is not proved to hold the primitive.
#pragma once

#include <cmath>

#include "shapes/primitive.hpp"

namespace lostbits::measure::offset {

/// Returns the same as `ball_around`, but also accepts a primitive with a stored inverse A; its matrix is
/// adj(A)/det(A).
inline auto bounding_ball_of(const Primitive<double>& primitive) {
    if (!primitive.transform || !primitive.transform->is_inverse) return ball_around(primitive);
    Primitive<double> object_primitive = primitive;
    object_primitive.transform.reset();
    auto ball = ball_around(object_primitive);
    const Affine<double> m = primitive.transform->map();
    const auto columns = m.adjugate();
    const double det = m.determinant();
    ball.centre = times(columns, ball.centre - m.shift) / det;
    ball.radius *= std::sqrt(square(columns[0]) + square(columns[1]) + square(columns[2])) / std::fabs(det);
    return ball;
}

}  // namespace lostbits::measure::offset
