// The method that first subtracts the position of the primitive, and then applies only the linear part. With the matrix
// of a camera this is called camera-relative.
#pragma once

#include "intersect/transform/plain.hpp"

namespace lostbits::intersect::transform {

/// τ − o is exact if the two are within a factor of two of each other in each component (Sterbenz). So the error of the
/// ray does not grow with the distance from the origin of the world.
struct RelativeTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "relative",
        .title = "o - T first, then A^-1 of it and of d; t kept",
        .source = "Cozzi and Ring, 3D Engine Design for Virtual Globes, 2011, section 5.2 (relative to center)",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return adjugate_over_determinant(m);
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        return named("o'", matrices.to_object.linear(named("o - T", Vec<T>(o - matrices.to_world.shift))));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return PlainTransform::direction(matrices, d);
    }
};

}  // namespace lostbits::intersect::transform
