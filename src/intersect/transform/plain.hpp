// The plain method, written without regard to rounding: it computes the inverse matrix, and its products with o and d.
#pragma once

#include "intersect/transform/info.hpp"

namespace lostbits::intersect::transform {

struct PlainTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "plain",
        .title = "adjugate over determinant; M^-1 o and M^-1 d, t kept",
        .source =
            "the DirectX Raytracing specification, Primitive/object space system values: ObjectRayOrigin, "
            "ObjectRayDirection, WorldToObject3x4",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return adjugate_over_determinant(m);
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        return named("o'", matrices.to_object.point(o));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return named("d'", matrices.to_object.linear(d));
    }
};

}  // namespace lostbits::intersect::transform
