// The transform of Mitsuba 3 into the space of an instance.
#pragma once

#include "intersect/transform/info.hpp"

namespace lostbits::intersect::transform {

struct MitsubaTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "mitsuba",
        .title = "columns added by fma to the shift, x first; t kept",
        .source = "Mitsuba 3, include/mitsuba/core/transform.h transform_affine, src/shapes/instance.cpp",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return adjugate_times_reciprocal(m);
    }
    /// fma(a.z, o.z, fma(a.y, o.y, fma(a.x, o.x, τ))) for each row; τ is `shift`.
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        const auto row_product = [&](std::size_t i) {
            const Vec<T>& a = matrices.to_object.rows[i];
            return fma(a.z, o.z, fma(a.y, o.y, fma(a.x, o.x, matrices.to_object.shift[static_cast<int>(i)])));
        };
        return named("o'", Vec<T>(row_product(0), row_product(1), row_product(2)));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        const auto row_product = [&](std::size_t i) {
            const Vec<T>& a = matrices.to_object.rows[i];
            return fma(a.z, d.z, fma(a.y, d.y, a.x * d.x));
        };
        return named("d'", Vec<T>(row_product(0), row_product(1), row_product(2)));
    }
};

}  // namespace lostbits::intersect::transform
