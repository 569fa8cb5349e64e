// Where a line crosses a surface without thickness, over any number: the span of a shape that has no inside.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// The one t at which a line crosses a flat piece of surface, and whether it does. A line beside its plane, or in it,
/// crosses nothing: `closed` is no.
template <class T>
struct FlatSpan {
    Fraction<T> at;    ///< n/m, m > 0 where the line crosses the plane
    mask_t<T> closed;  ///< it crosses the piece or its rim
    mask_t<T> open;    ///< and not the rim
    T d2;              ///< d·d
};

/// Both ends are where it crosses; nothing where it is not known to.
template <Number T>
std::optional<Ends<T>> ends_of(const FlatSpan<T>& s) {
    if (!is_certain(s.closed)) return std::nullopt;
    const T t = s.at.n / s.at.m;
    return Ends<T>{t, t};
}

}  // namespace lostbits
