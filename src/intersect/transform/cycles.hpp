// The transform of Cycles into the space of an instance, up to Blender 3.2: the direction is normalised, and t is
// divided by its former length.
#pragma once

#include "intersect/transform/plain.hpp"

namespace lostbits::intersect::transform {

struct CyclesTransform : NormalisingMethod {
    static constexpr TransformMethodInfo info{
        .name = "cycles",
        .title = "M^-1 o and M^-1 d, made unit; t over its length",
        .source = "Cycles, kernel/geom/geom_object.h bvh_instance_push with normalize_len, up to Blender 3.2",
        .normalises = true,
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return adjugate_times_reciprocal(m);
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        return PlainTransform::origin(matrices, o);
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return PlainTransform::direction(matrices, d);
    }
};

}  // namespace lostbits::intersect::transform
