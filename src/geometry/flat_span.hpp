// The crossing of a line and a flat surface, over any number. Its span serves shapes without an inside.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// Says if a line crosses a surface: with its rim (`closed`), or without it (`open`).
template <class Mask>
struct SurfaceCrossing {
    Mask closed, open;
};

/// A span of a surface without an inside. It lists its possible crossings in the order of t, and compares each crossing
/// with a fraction.
template <class S, class T>
concept SurfaceSpan = requires(const S& s, const Fraction<T>& t) {
    S::crossing_count, s.crossing(0), s.compare_crossing(0, t);
};

/// The t at which a line crosses the plane of a flat surface, and whether it crosses the surface there. A line parallel
/// to the plane, or in it, has no crossing: `closed` is false.
template <class T>
struct FlatSpan {
    Fraction<T> at;      ///< n/m, m > 0 where the line crosses the plane
    mask_t<T> closed;    ///< the line crosses the surface or its rim
    mask_t<T> open;      ///< the line crosses the surface, not its rim
    mask_t<T> is_front;  ///< the line comes from the side that the normal points to, d·n < 0; valid if the line crosses
    T d2;                ///< d·d

    static constexpr int crossing_count = 1;
    static constexpr bool may_hit_beyond_touch = false;
    [[nodiscard]] SurfaceCrossing<mask_t<T>> crossing(int) const { return {closed, open}; }
    [[nodiscard]] Order<mask_t<T>> compare_crossing(int, const Fraction<T>& t) const { return order_of(at, t); }
};

/// Returns the crossing as entry and exit. Returns nothing if the line is not known to cross.
template <Number T>
std::optional<Ends<T>> ends_of(const FlatSpan<T>& span) {
    if (!is_certain(span.closed)) return std::nullopt;
    const T t = span.at.n / span.at.m;
    return Ends<T>{t, t};
}

}  // namespace lostbits
