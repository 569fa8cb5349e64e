// The method without an inverse: the ray is multiplied by the adjugate matrix, and the primitive is |det(A)| times as
// large.
#pragma once

#include "intersect/transform/relative.hpp"

namespace lostbits::intersect::transform {

/// The method that the truth uses, in the format: the ray adj(A)(o − τ) + t adj(A) d and the primitive times |det A|.
/// If det A < 0, the ray is mirrored.
struct AdjugateTransform : RelativeTransform {
    static constexpr TransformMethodInfo info{
        .name = "adjugate",
        .title = "adj(A)(o - T) and adj(A) d against the primitive times |det A|: no division; t kept",
        .source = "as in the truth of lostbits",
    };

    /// Returns the adjugate matrix in place of the inverse. Its shift is not used.
    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const auto columns = m.adjugate();
        const auto row = [&](int i) { return Vec<T>(columns[0][i], columns[1][i], columns[2][i]); };
        return {{row(0), row(1), row(2)}, m.shift};
    }
    template <Number T>
    static ObjectRay<T> finish(const MatrixPair<T>& matrices, const Vec<T>&, const Ray<T>& ray) {
        const T det = named("det", matrices.to_world.determinant()), sign = copysign(T(1), det);
        return {{sign * ray.origin, sign * ray.direction}, T(1), abs(det)};
    }
};

}  // namespace lostbits::intersect::transform
