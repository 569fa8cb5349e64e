// Where a line crosses a surface without thickness, over any number: the span of a shape that has no inside.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// Whether a line crosses a surface there: the surface with its rims, and that without.
template <class Mask>
struct SurfaceCrossing {
    Mask closed, open;
};

/// A span of a surface without an inside: its crossings in the order of t, each of which may not be one, and how each
/// stands to a fraction.
template <class S, class T>
concept SurfaceSpan = requires(const S& s, const Fraction<T>& t) {
    S::crossings, s.crossing(0), s.order_to(0, t);
};

/// The one t at which a line crosses a flat piece of surface, and whether it does. A line beside its plane, or in it,
/// crosses nothing: `closed` is no.
template <class T>
struct FlatSpan {
    Fraction<T> at;    ///< n/m, m > 0 where the line crosses the plane
    mask_t<T> closed;  ///< it crosses the piece or its rim
    mask_t<T> open;    ///< and not the rim
    mask_t<T> front;   ///< it comes from the side that the normal points to, d·n < 0: known where it crosses
    T d2;              ///< d·d

    static constexpr int crossings = 1;
    static constexpr bool is_met_behind_touch = false;
    [[nodiscard]] SurfaceCrossing<mask_t<T>> crossing(int) const { return {closed, open}; }
    [[nodiscard]] Order<mask_t<T>> order_to(int, const Fraction<T>& t) const { return order_of(at, t); }
};

/// Both ends are where it crosses; nothing where it is not known to.
template <Number T>
std::optional<Ends<T>> ends_of(const FlatSpan<T>& s) {
    if (!is_certain(s.closed)) return std::nullopt;
    const T t = s.at.n / s.at.m;
    return Ends<T>{t, t};
}

}  // namespace lostbits
