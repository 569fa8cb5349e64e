// Bounding ball of a primitive in the world, in doubles, for uses that need no proof.
#pragma once

#include <cmath>

#include "shapes/solid.hpp"

namespace lostbits::measure::offset {

/// Like `ball_around`, but also for a primitive under a stored inverse, whose matrix is adj(A)/det(A).
inline auto ball_of(const Solid<double>& solid) {
    if (!solid.placed || !solid.placed->is_inverse) return ball_around(solid);
    Solid<double> there = solid;
    there.placed.reset();
    auto ball = ball_around(there);
    const Affine<double> m = solid.placed->map();
    const auto columns = m.adjugate();
    const double det = m.determinant();
    ball.centre = times(columns, ball.centre - m.shift) / det;
    ball.radius *= std::sqrt(square(columns[0]) + square(columns[1]) + square(columns[2])) / std::fabs(det);
    return ball;
}

}  // namespace lostbits::measure::offset
