// The transform of a primitive: the stored numbers of its matrix, and the transformation of rays and points to the
// space of the primitive.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "geometry/affine.hpp"
#include "geometry/ray.hpp"

namespace lostbits {

/// Returns the exact sign of the determinant of a matrix, or 0 if a number is not finite. The matrix is given by row,
/// as twelve numbers. The overload for 256-bit numbers is in lift.hpp, because the packs include this header and must
/// not depend on MPFR.
int orientation_of(std::span<const double, 12> matrix);

/// A stored matrix of three rows and four columns, row by row, and whether it is the inverse.
template <class S>
struct Transform {
    std::array<S, Affine<S>::number_count> matrix;
    bool is_inverse = false;  ///< true: from the world to the primitive; false: from the primitive to the world
    int orientation = 1;  ///< sign of the determinant: −1 if the matrix mirrors, 0 if it is singular or not finite

    [[nodiscard]] Affine<S> map() const {
        return Affine<S>::of([this](std::size_t k) { return matrix[k]; });
    }
    /// True if all numbers are finite and the matrix has an inverse.
    [[nodiscard]] bool is_proper() const { return orientation != 0; }
    friend bool operator==(const Transform&, const Transform&) = default;
};

/// Converts each number by `lift`. If the result is in doubles, `lift` may have rounded, so the sign of the determinant
/// is computed again. If a caller rounds in a wider number type, it must compute the sign itself.
template <class S, class Lift>
auto convert_numbers(const Transform<S>& transform, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    const auto numbers = [&]<std::size_t... k>(std::index_sequence<k...>) {
        return std::array<T, sizeof...(k)>{lift(transform.matrix[k])...};
    };
    constexpr std::make_index_sequence<Affine<T>::number_count> indices;
    Transform<T> result{numbers(indices), transform.is_inverse, transform.orientation};
    if constexpr (std::same_as<T, double>) result.orientation = orientation_of(result.matrix);
    return result;
}

/// A world ray in the space of the stored primitive: the same line with the same t, if the primitive is made `scale` >
/// 0 times as large.
template <class E>
struct ObjectSpaceRay {
    Ray<E> ray;
    E scale;
};

/// Transforms a ray to the space of the stored primitive. M = [A τ] leads from the primitive to the world. With v = o −
/// τ, p' = A⁻¹(p − τ) turns the ray into (adj(A) v + t adj(A) d)/det A. To avoid a division, the ray and the primitive
/// are multiplied by |det A|. With s the sign of det A,
///     o' = s adj(A) v,   d' = s adj(A) d,   and the primitive is s det A = |det A| times as large.
/// For a stored inverse, o' = A o + τ, d' = A d, and the primitive keeps its size.
template <class E>
ObjectSpaceRay<E> to_object_space(const Ray<E>& ray, const Transform<E>& transform) {
    const Affine<E> m = transform.map();
    if (transform.is_inverse) return {{m.point(ray.origin), m.linear(ray.direction)}, E(1)};
    const E sign(transform.orientation);
    const auto adjugate = m.adjugate();
    return {{sign * times(adjugate, ray.origin - m.shift), sign * times(adjugate, ray.direction)},
            sign * m.determinant()};
}

/// Transforms the world point p to the space of the stored primitive.
template <class E>
Vec<E> point_to_object_space(const Vec<E>& p, const Transform<E>& transform) {
    const Affine<E> m = transform.map();
    if (transform.is_inverse) return m.point(p);
    const E det = m.determinant();
    const Vec<E> scaled = times(m.adjugate(), p - m.shift);
    return {scaled.x / det, scaled.y / det, scaled.z / det};
}

}  // namespace lostbits
