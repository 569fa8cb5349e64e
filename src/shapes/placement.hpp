// Solids that stand under a matrix: the stored numbers of it, and the same question put in the space of the solid.
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

/// The sign of the determinant, exactly; 0 too where a number is not finite. By row, twelve numbers. That of numbers of
/// 256 bits is in lift.hpp: what the packs include knows no MPFR.
int orientation_of(std::span<const double, 12> matrix);

/// A stored matrix of three rows and four columns, row by row, and which way it leads.
template <class S>
struct Placement {
    std::array<S, Affine<S>::numbers> matrix;
    bool is_inverse = false;  ///< it leads from the world to the solid; else from the solid to the world
    int orientation = 1;      ///< the sign of the determinant: −1 where it mirrors, 0 where it is none

    [[nodiscard]] Affine<S> map() const {
        return Affine<S>::of([this](std::size_t k) { return matrix[k]; });
    }
    /// Whether all of its numbers are numbers, and it can be undone.
    [[nodiscard]] bool is_proper() const { return orientation != 0; }
    friend bool operator==(const Placement&, const Placement&) = default;
};

/// Each number through `lift`. Of doubles, which may have been rounded, the sign is found anew; whoever rounds in a
/// wider number finds it.
template <class S, class Lift>
auto transformed(const Placement<S>& from, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    const auto numbers = [&]<std::size_t... k>(std::index_sequence<k...>) {
        return std::array<T, sizeof...(k)>{lift(from.matrix[k])...};
    };
    constexpr std::make_index_sequence<Affine<T>::numbers> places;
    Placement<T> to{numbers(places), from.is_inverse, from.orientation};
    if constexpr (std::same_as<T, double>) to.orientation = orientation_of(to.matrix);
    return to;
}

/// How a ray of the world stands to the solid as it is stored: the same line, at the same t, of what is `scale` > 0
/// times as large.
template <class E>
struct InObject {
    Ray<E> ray;
    E scale;
};

/// With M = [A τ] from the solid to the world and v = o − τ, p' = A⁻¹(p − τ) makes of the ray (adj(A) v + t adj(A) d)/
/// det A. Multiplied by |det A|, and mirrored with the solid where det A < 0, no number is divided: with s the sign,
///     o' = s adj(A) v,   d' = s adj(A) d,   the solid s det A = |det A| times as large.
/// Of a stored inverse o' = A o + τ, d' = A d, and the solid as it is.
template <class E>
InObject<E> in_object(const Ray<E>& ray, const Placement<E>& placed) {
    const Affine<E> m = placed.map();
    if (placed.is_inverse) return {{m.point(ray.origin), m.linear(ray.direction)}, E(1)};
    const E sign(placed.orientation);
    const auto adjugate = m.adjugate();
    return {{sign * times(adjugate, ray.origin - m.shift), sign * times(adjugate, ray.direction)},
            sign * m.determinant()};
}

/// The point of the solid as it is stored that stands at p of the world.
template <class E>
Vec<E> point_in_object(const Vec<E>& p, const Placement<E>& placed) {
    const Affine<E> m = placed.map();
    if (placed.is_inverse) return m.point(p);
    const E det = m.determinant();
    const Vec<E> scaled = times(m.adjugate(), p - m.shift);
    return {scaled.x / det, scaled.y / det, scaled.z / det};
}

}  // namespace lostbits
