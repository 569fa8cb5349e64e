// Where a line o + t d is inside of a solid, over any number: what the truth of every shape is made from. A shape says
// which of these its span is and what stands in it; all that is asked of one is asked of these.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "geometry/vec.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Whether a mask is certain to hold; of a number that always tells, whether it holds.
inline constexpr bool is_certain(bool mask) { return mask; }
inline constexpr bool is_certain(Tri mask) { return mask.is_yes(); }

/// Those t at which a t² + 2 h t + c ≤ 0: between (−h ∓ √q)/a, with q = h² − a c in the form that subtracts least. What
/// is met is the surface, c(o) = 0. `a` is positive.
template <class T>
struct QuadraticSpan {
    T h, c, a, q;
    T d2;  ///< d·d
};

/// n/m with m > 0 for certain. Fractions are compared by n₁ m₂ against n₂ m₁: of equal fractions these become the same
/// number at some precision, which the quotients need not.
template <class T>
struct Fraction {
    T n;
    T m;
};

/// What slabs leave of the line: those t that are at least every `entry` and at most every `exit`, one of each for
/// every slab that the line crosses. And what no t changes, for the closed and the open solid.
template <class T>
struct SlabSpan {
    std::array<std::optional<Fraction<T>>, 3> entry, exit;
    mask_t<T> closed;  ///< o lies in each slab that the line does not cross
    mask_t<T> open;    ///< o lies in the open one, and no slab is without thickness
    T d2;              ///< d·d
};

/// Where a line enters and leaves: near ≤ far where it meets the solid.
template <class T>
struct Ends {
    T near, far;
};

template <Number T>
std::optional<Ends<T>> ends_of(const QuadraticSpan<T>& s) {
    const T root = sqrt(s.q);
    return Ends<T>{(-s.h - root) / s.a, (root - s.h) / s.a};
}

/// The largest entry and the smallest exit, of two that cannot be told apart both; nothing where no slab is crossed.
template <Number T>
std::optional<Ends<T>> ends_of(const SlabSpan<T>& s) {
    std::optional<Ends<T>> ends;
    for (std::size_t i = 0; i < s.entry.size(); ++i) {
        if (!s.entry[i]) continue;
        const T in = s.entry[i]->n / s.entry[i]->m, out = s.exit[i]->n / s.exit[i]->m;
        ends = ends ? Ends<T>{max(ends->near, in), min(ends->far, out)} : Ends<T>{in, out};
    }
    return ends;
}

}  // namespace lostbits
