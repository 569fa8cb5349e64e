// The method with the transpose in place of the inverse, which is right for rotations only.
#pragma once

#include "intersect/transform/relative.hpp"

namespace lostbits::intersect::transform {

/// Aᵀ = A⁻¹ for a rotation. For a rounded rotation the equation holds to a few u; for any other matrix Aᵀ is a
/// different map.
struct RigidTransform : RelativeTransform {
    static constexpr TransformMethodInfo info{
        .name = "rigid",
        .title = "A^T for A^-1: right for rotations only; o - T first, t kept",
        .source = "Eberly, Geometric Tools, rigid transforms; Lengyel, Foundations of Game Engine Development, 2016",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const auto column = [&](int i) { return Vec<T>(m.rows[0][i], m.rows[1][i], m.rows[2][i]); };
        Affine<T> inverse{{column(0), column(1), column(2)}, m.shift};
        inverse.shift = -inverse.linear(m.shift);
        return inverse;
    }
};

}  // namespace lostbits::intersect::transform
