// The transform of Embree into the space of an instance, on machines with fused multiplications.
#pragma once

#include "intersect/transform/info.hpp"

namespace lostbits::intersect::transform {

struct EmbreeTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "embree",
        .title = "adjoint over determinant; rows by fma from the last component on, t kept",
        .source = "Embree 3 and 4, common/math/affinespace.h rcp, xfmPoint, linearspace3.h inverse",
    };

    /// det = u·(v × w) of the columns; shift = −(A⁻¹τ) by fma.
    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const auto column = [&](int i) { return Vec<T>(m.rows[0][i], m.rows[1][i], m.rows[2][i]); };
        const Vec<T> u = column(0), v = column(1), w = column(2);
        const T det = named("det", dot(u, cross(v, w)));
        const auto over_det = [&](const Vec<T>& x) { return named("A^-1", Vec<T>(x.x / det, x.y / det, x.z / det)); };
        Affine<T> inverse{{over_det(cross(v, w)), over_det(cross(w, u)), over_det(cross(u, v))}, m.shift};
        inverse.shift = -linear_by_fma(inverse, m.shift);
        return inverse;
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        return named("o'", point_by_fma(matrices.to_object, o));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return named("d'", linear_by_fma(matrices.to_object, d));
    }
};

}  // namespace lostbits::intersect::transform
