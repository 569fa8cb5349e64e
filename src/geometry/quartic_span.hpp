// The part of a line inside a surface of degree four, over any number: tori.
#pragma once

#include <optional>

#include "geometry/real_roots.hpp"
#include "geometry/span.hpp"

namespace lostbits {

/// The t at which f(x) ≤ 0, with x = a t + b and f = n x⁴ + p x² + q x + r, where n, a > 0: no interval, one, or two.
/// The real roots of f lie within ±bound.
template <class T>
struct QuarticSpan {
    Polynomial<T> f;
    T a, b, bound;
    T d2;  ///< d·d

    static constexpr bool may_hit_behind_touch = true;

    /// Value of x at t = n/m, m > 0.
    [[nodiscard]] T place(const T& t) const { return a * t + b; }
    [[nodiscard]] T time(const T& x) const { return (x - b) / a; }
};

/// First interval that does not end before t = 0, or else the last; nothing if none is known.
template <Number T>
std::optional<Ends<T>> ends_of(const QuarticSpan<T>& s) {
    std::array<T, 4> crossings;
    int count = 0, first = 0;
    if constexpr (std::same_as<mask_t<T>, bool>) {
        const NearRoots<T> near = near_roots(s.f, s.bound);
        crossings = near.x, count = near.count;
        if (count > 2 && crossings[1] < s.b) first = 2;
    } else {
        const auto roots = enclosed_roots(s.f, s.bound);
        if (!roots) return std::nullopt;
        std::array<int, 4> which;
        for (int i = 0; i < roots->count; ++i)
            if ((*roots)[i].crosses)
                which[static_cast<std::size_t>(count)] = i,
                crossings[static_cast<std::size_t>(count++)] = (*roots)[i].root;
        if (count > 2) {
            const auto order = roots->order(which[1], s.b);
            if (!order) return std::nullopt;
            if (*order < 0) first = 2;
        }
    }
    if (count < first + 2) return std::nullopt;
    const auto at = static_cast<std::size_t>(first);
    return Ends<T>{s.time(crossings[at]), s.time(crossings[at + 1])};
}

}  // namespace lostbits
