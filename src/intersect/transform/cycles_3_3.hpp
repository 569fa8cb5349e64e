// The transform of Cycles into the space of an instance, from Blender 3.3 on: nothing is normalised, and t is kept.
#pragma once

#include "intersect/transform/embree.hpp"

namespace lostbits::intersect::transform {

/// The method as it runs on processors with fused multiplications. The inverse is computed as in Embree: cross products
/// with one fused operation, dot products without.
struct Cycles33Transform : EmbreeTransform {
    static constexpr TransformMethodInfo info{
        .name = "cycles_3_3",
        .title =
            "adjoint over determinant by fma; rows by fma from the last component on, |d'| kept above 2^-80; t kept",
        .source =
            "Cycles from Blender 3.3 on (83b7485e7), src/kernel/geom/object.h:449-477 bvh_instance_push, "
            "src/util/transform.h:86, 157, 529",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const auto column = [&](int i) { return Vec<T>(m.rows[0][i], m.rows[1][i], m.rows[2][i]); };
        const Vec<T> x = column(0), y = column(1), z = column(2);
        const T det = named("det", dot(x, cross_by_fma(y, z)));
        const auto over_det = [&](const Vec<T>& v) { return named("A^-1", Vec<T>(v.x / det, v.y / det, v.z / det)); };
        Affine<T> inverse{{over_det(cross_by_fma(y, z)), over_det(cross_by_fma(z, x)), over_det(cross_by_fma(x, y))},
                          m.shift};
        inverse.shift = -inverse.linear(m.shift);
        return inverse;
    }
    /// The constant 8.271806E-25f of Cycles is 2^-80. It is 0 in formats whose exponents do not reach it.
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        const T two_to_minus_10 = T(1) / T(1024), two_to_minus_20 = two_to_minus_10 * two_to_minus_10,
                two_to_minus_40 = two_to_minus_20 * two_to_minus_20, min_magnitude = two_to_minus_40 * two_to_minus_40;
        const auto away_from_zero = [&](const T& x) {
            return select(abs(x) > min_magnitude, x, copysign(min_magnitude, x));
        };
        const Vec<T> v = linear_by_fma(matrices.to_object, d);
        return named("d'", Vec<T>(away_from_zero(v.x), away_from_zero(v.y), away_from_zero(v.z)));
    }

private:
    /// The cross product, each component as fma(a, b, −(c d)).
    template <Number T>
    static Vec<T> cross_by_fma(const Vec<T>& a, const Vec<T>& b) {
        return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
    }
};

}  // namespace lostbits::intersect::transform
