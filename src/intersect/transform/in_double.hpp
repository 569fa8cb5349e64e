// The method in the next wider arithmetic of one word: in double for floats, as in engines with large worlds.
#pragma once

#include "intersect/transform/relative.hpp"

namespace lostbits::intersect::transform {

/// The stored matrix and the ray are widened first, so that inverse, origin and direction are each rounded once, to the
/// format in which the form runs. If no arithmetic is wider, the method is the same as `relative`.
struct InDoubleTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "in_double",
        .title = "inverse, origin and direction in the next wider format, each rounded once; t kept",
        .source = "Godot and Unreal Engine 5 with large worlds: transforms in double, shapes in float",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const auto wide = RelativeTransform::inverse(widened(m));
        return {{narrowed<T>(wide.rows[0]), narrowed<T>(wide.rows[1]), narrowed<T>(wide.rows[2])},
                narrowed<T>(wide.shift)};
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        return named("o'", narrowed<T>(RelativeTransform::origin(wide_maps(matrices), widened(o))));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return named("d'", narrowed<T>(RelativeTransform::direction(wide_maps(matrices), widened(d))));
    }

private:
    template <class T>
    using Wide = typename Wider<T>::type;

    template <Number T>
    static Vec<Wide<T>> widened(const Vec<T>& v) {
        return {Wider<T>::widen(v.x), Wider<T>::widen(v.y), Wider<T>::widen(v.z)};
    }
    template <Number T>
    static Affine<Wide<T>> widened(const Affine<T>& m) {
        return {{widened(m.rows[0]), widened(m.rows[1]), widened(m.rows[2])}, widened(m.shift)};
    }
    template <Number T>
    static Vec<T> narrowed(const Vec<Wide<T>>& v) {
        return {Wider<T>::narrow(v.x), Wider<T>::narrow(v.y), Wider<T>::narrow(v.z)};
    }
    template <Number T>
    static MatrixPair<Wide<T>> wide_maps(const MatrixPair<T>& matrices) {
        const Affine<Wide<T>> world = widened(matrices.to_world);
        return {world, RelativeTransform::inverse(world)};
    }
};

}  // namespace lostbits::intersect::transform
