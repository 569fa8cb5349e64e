// Where a line is inside of a convex solid that is joined of several surfaces of quadratics, over any number: capsules.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// Those t from the near root of one quadratic to the far root of another, whichever of several they are: what a line
/// enters and what it leaves, where it meets the solid. Where it does not, `enter` has no roots.
template <class T>
struct JoinedSpan {
    QuadraticSpan<T> enter, leave;
    T d2;  ///< d·d

    static constexpr bool is_met_behind_touch = false;

    /// Whether some point of the line lies in the closed and in the open solid.
    [[nodiscard]] mask_t<T> is_met() const { return enter.q >= T(0) && leave.q >= T(0); }
    [[nodiscard]] mask_t<T> is_open() const { return enter.q > T(0) && leave.q > T(0); }
    /// Whether the line enters before t, or no later, and whether it leaves so, where it meets the closed solid.
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> enters_to(const At& t) const {
        return quadratic_at(enter, t).near_root();
    }
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> leaves_to(const At& t) const {
        return quadratic_at(leave, t).far_root();
    }
};

template <class T>
QuadraticSpan<T> select(const mask_t<T>& mask, const QuadraticSpan<T>& a, const QuadraticSpan<T>& b) {
    return {select(mask, a.h, b.h), select(mask, a.c, b.c), select(mask, a.a, b.a), select(mask, a.q, b.q),
            select(mask, a.d2, b.d2)};
}

/// Both ends.
template <Number T>
std::optional<Ends<T>> ends_of(const JoinedSpan<T>& s) {
    return Ends<T>{ends_of(s.enter)->near, ends_of(s.leave)->far};
}

}  // namespace lostbits
