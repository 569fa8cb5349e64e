// Bounding ball of a primitive in the world, in doubles, for uses that need no proof.
#pragma once

#include <cmath>

#include "shapes/primitive.hpp"

namespace lostbits::measure::offset {

/// Like `ball_around`, but also for a primitive under a stored inverse, whose matrix is adj(A)/det(A).
inline auto ball_of(const Primitive<double>& primitive) {
    if (!primitive.placed || !primitive.placed->is_inverse) return ball_around(primitive);
    Primitive<double> there = primitive;
    there.placed.reset();
    auto ball = ball_around(there);
    const Affine<double> m = primitive.placed->map();
    const auto columns = m.adjugate();
    const double det = m.determinant();
    ball.centre = times(columns, ball.centre - m.shift) / det;
    ball.radius *= std::sqrt(square(columns[0]) + square(columns[1]) + square(columns[2])) / std::fabs(det);
    return ball;
}

}  // namespace lostbits::measure::offset
