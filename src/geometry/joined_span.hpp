// The part of a line inside a convex primitive that joins several quadric surfaces, over any number: capsules.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// The t from the near root of one quadratic (where the line enters) to the far root of another (where it leaves). If
/// the line misses the primitive, `enter` has no roots.
template <class T>
struct JoinedSpan {
    QuadraticSpan<T> enter, leave;
    T d2;  ///< d·d

    static constexpr bool may_hit_beyond_touch = false;

    /// True if some point of the line lies in the closed (`meets_closed`) or in the open primitive (`meets_open`).
    [[nodiscard]] mask_t<T> meets_closed() const { return enter.q >= T(0) && leave.q >= T(0); }
    [[nodiscard]] mask_t<T> meets_open() const { return enter.q > T(0) && leave.q > T(0); }
    /// Compares the entry (`compare_entry`) or the exit (`compare_exit`) of a line that meets the closed primitive with
    /// t: before t (`less`), or no later (`at_most`).
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> compare_entry(const At& t) const {
        return quadratic_at(enter, t).order_of_near_root();
    }
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> compare_exit(const At& t) const {
        return quadratic_at(leave, t).order_of_far_root();
    }
};

template <class T>
QuadraticSpan<T> select(const mask_t<T>& mask, const QuadraticSpan<T>& a, const QuadraticSpan<T>& b) {
    return {select(mask, a.h, b.h), select(mask, a.c, b.c), select(mask, a.a, b.a), select(mask, a.q, b.q),
            select(mask, a.d2, b.d2)};
}

/// Entry and exit of a line.
template <Number T>
std::optional<Ends<T>> ends_of(const JoinedSpan<T>& span) {
    return Ends<T>{ends_of(span.enter)->near, ends_of(span.leave)->far};
}

}  // namespace lostbits
