// The method in double-double arithmetic: it subtracts the position of the primitive and multiplies by the inverse in
// two words of the format, and rounds each result once.
#pragma once

#include "intersect/transform/relative.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::intersect::transform {

/// The inverse of the stored matrix is computed in two words as well. The second word is dropped only at the end of
/// each step.
struct TwoWordsTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "two_words",
        .title = "inverse, origin and direction in two words of the format, each rounded once; t kept",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
    };

    /// The rounded inverse. If the matrix to the world is the stored one, the steps below do not use it: each inverts
    /// that matrix in two words.
    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        if constexpr (is_exact<T>) return adjugate_over_determinant(m);
        else {
            const auto wide = adjugate_over_determinant(to_words(m));
            return {{first_words(wide.rows[0]), first_words(wide.rows[1]), first_words(wide.rows[2])},
                    first_words(wide.shift)};
        }
    }
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        if constexpr (is_exact<T>) return RelativeTransform::origin(matrices, o);
        else
            return named("o'",
                         first_words(solve(matrices, Vec<Words<T>>(to_words(o) - to_words(matrices.to_world.shift)))));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        if constexpr (is_exact<T>) return RelativeTransform::direction(matrices, d);
        else return named("d'", first_words(solve(matrices, to_words(d))));
    }

private:
    template <class T>
    using Words = number::wide::TwoWords<T>;

    template <Number T>
    static Vec<Words<T>> to_words(const Vec<T>& v) {
        return {Words<T>(v.x), Words<T>(v.y), Words<T>(v.z)};
    }
    template <Number T>
    static Affine<Words<T>> to_words(const Affine<T>& m) {
        return {{to_words(m.rows[0]), to_words(m.rows[1]), to_words(m.rows[2])}, to_words(m.shift)};
    }
    template <Number T>
    static Vec<T> first_words(const Vec<Words<T>>& v) {
        return {v.x.hi, v.y.hi, v.z.hi};
    }
    /// adj(A) v/det(A).
    template <Number T>
    static Vec<Words<T>> solve(const MatrixPair<T>& matrices, const Vec<Words<T>>& v) {
        const Affine<Words<T>> world = to_words(matrices.to_world);
        const Words<T> det = world.determinant();
        const Vec<Words<T>> scaled = times(world.adjugate(), v);
        return {scaled.x / det, scaled.y / det, scaled.z / det};
    }
};

}  // namespace lostbits::intersect::transform
