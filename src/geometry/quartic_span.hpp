// The part of a line inside a surface of degree four, over any number: tori.
#pragma once

#include <optional>

#include "geometry/real_roots.hpp"
#include "geometry/span.hpp"

namespace lostbits {

/// The t at which f(x) ≤ 0, with x = a t + b and f = n x⁴ + p x² + q x + r, where n, a > 0. These t form no interval,
/// one, or two. The real roots of f lie within ±bound.
template <class T>
struct QuarticSpan {
    Polynomial<T> f;
    T a, b, bound;
    T d2;  ///< d·d

    static constexpr bool may_hit_beyond_touch = true;

    /// Converts between t and x.
    [[nodiscard]] T x_at(const T& t) const { return a * t + b; }
    [[nodiscard]] T t_at(const T& x) const { return (x - b) / a; }
};

/// The first interval that does not end before t = 0, or the last one if all end before it. Returns nothing if no
/// interval is known.
template <Number T>
std::optional<Ends<T>> ends_of(const QuarticSpan<T>& span) {
    // Finds where the line crosses the surface. The second interval counts if the first ends before t = 0, where x = b.
    std::array<T, 4> crossings;
    int count = 0, first = 0;
    if constexpr (std::same_as<mask_t<T>, bool>) {
        const ApproximateRoots<T> approximations = approximate_roots(span.f, span.bound);
        crossings = approximations.x;
        count = approximations.count;
        if (count > 2 && crossings[1] < span.b) first = 2;
    } else {
        const auto roots = enclose_roots(span.f, span.bound);
        if (!roots) return std::nullopt;
        std::array<int, 4> crossing_indices;
        for (int i = 0; i < roots->count; ++i) {
            if (!(*roots)[i].changes_sign) continue;
            crossing_indices[count] = i;
            crossings[count++] = (*roots)[i].root;
        }
        if (count > 2) {
            const auto order = roots->order(crossing_indices[1], span.b);
            if (!order) return std::nullopt;
            if (*order < 0) first = 2;
        }
    }

    if (count < first + 2) return std::nullopt;
    const auto index = static_cast<std::size_t>(first);
    return Ends<T>{span.t_at(crossings[index]), span.t_at(crossings[index + 1])};
}

}  // namespace lostbits
