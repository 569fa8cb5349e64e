// The part of a line inside a quadric surface that two planes cut off, over any number: cylinders and cones with caps.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// The t between two parallel planes, from `entry` to `exit`, at which P(t) = a t² + 2 h t + c ≤ 0. The primitive is
/// convex, so they form one interval, although `a` may have any sign. If P < 0 beyond both roots (a < 0: a line steeper
/// than a cone, which also meets the mirror image of the cone), one of the two parts lies between the planes. The line
/// enters by the plane at `entry` if P ≤ 0 there; otherwise it enters where P falls through 0, at (−h − √q)/a. Likewise
/// it leaves by the plane at `exit`, or where P rises through 0, at (−h + √q)/a. P and half of its slope at the planes
/// decide all of this, so no decision takes a root.
///
/// A line parallel to the planes has −1/0 and 1/0 for entry and exit, and a > 0. `closed` and `open` then say whether
/// it runs between the planes.
template <class T>
struct CappedSpan {
    QuadraticSpan<T> side;
    Fraction<T> entry, exit;
    QuadraticAt<T> at_entry, at_exit;
    mask_t<T> crossed;
    mask_t<T> closed;
    mask_t<T> open;
    T d2;  ///< d·d

    static constexpr bool may_hit_behind_touch = false;

    /// True if some point of the line lies in the closed primitive. It is enough to examine the points at the planes
    /// and at the minimum of P.
    [[nodiscard]] mask_t<T> is_hit() const {
        const T zero(0);
        const auto through = side.q >= zero;
        const auto met = enters_by_cap() || leaves_by_cap() || (is_least_between() && through);
        return closed && ((crossed && met) || (!crossed && through));
    }
    /// The same for the open primitive.
    [[nodiscard]] mask_t<T> is_open() const {
        const T zero(0);
        const auto through = side.q > zero;
        const auto met = at_entry.value < zero || at_exit.value < zero || (is_least_between() && through);
        return open && ((crossed && met) || (!crossed && through));
    }
    /// Compares entering and leaving with t (before, or no later), for a line that meets the closed primitive. If t is
    /// past `entry` and P > 0, the line has left if it entered by the plane or if t is past the minimum of P, which
    /// exists only for a > 0. Otherwise it has yet to enter.
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> enters_to(const At& t) const {
        const T zero(0);
        const auto cap = order_of(entry, t);
        const auto& [value, half_slope] = quadratic_at(side, t);
        const auto opens_upwards = side.a > zero, by_cap = crossed && enters_by_cap();
        return {(!crossed || cap.less) && (by_cap || value < zero || (opens_upwards && half_slope > zero)),
                (!crossed || cap.at_most) && (by_cap || value <= zero || (opens_upwards && half_slope >= zero))};
    }
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> leaves_to(const At& t) const {
        const T zero(0);
        const auto from = order_of(entry, t), to = order_of(exit, t);
        const auto& [value, half_slope] = quadratic_at(side, t);
        const auto opens_upwards = side.a > zero, by_cap = crossed && enters_by_cap(), out = value > zero;
        const auto out_behind = out && ((opens_upwards && half_slope > zero) || (by_cap && from.less));
        const auto on_or_behind = value >= zero && ((opens_upwards && half_slope >= zero) ||
                                                    (by_cap && from.at_most && (out || half_slope > zero)));
        return {out_behind || (crossed && to.less), on_or_behind || (crossed && to.at_most)};
    }
    /// True if the line enters, or leaves, by a plane, for a line that meets the closed primitive. At a rim either
    /// answer is possible.
    [[nodiscard]] mask_t<T> enters_by_cap() const { return crossed && at_entry.value <= T(0); }
    [[nodiscard]] mask_t<T> leaves_by_cap() const { return crossed && at_exit.value <= T(0); }

private:
    [[nodiscard]] mask_t<T> is_least_between() const { return at_entry.half_slope < T(0) && at_exit.half_slope > T(0); }
};

/// Builds the span for the planes v·(p − base) = 0 and = v². `low` is v·(o − base), and
/// `along_axis` is v·d.
template <class T>
CappedSpan<T> capped(const QuadraticSpan<T>& side, const T& low, const T& along_axis, const T& v2) {
    const T zero(0), one(1);
    const auto up = along_axis > zero, crossed = up || along_axis < zero;
    const T size = select(up, along_axis, -along_axis);
    const Fraction<T> to_base{-low, size}, to_top{v2 - low, size}, from_top{-to_top.n, size}, from_base{low, size};
    const Fraction<T> before{-one, zero}, after{one, zero};
    const Fraction<T> entry = select(crossed, select(up, to_base, from_top), before);
    const Fraction<T> exit = select(crossed, select(up, to_top, from_base), after);
    return {.side = side,
            .entry = entry,
            .exit = exit,
            .at_entry = quadratic_at(side, entry),
            .at_exit = quadratic_at(side, exit),
            .crossed = crossed,
            .closed = crossed || (low >= zero && low <= v2),
            .open = crossed || (low > zero && low < v2),
            .d2 = side.d2};
}

/// Both ends; nothing if the surfaces by which the line enters and leaves are not known.
template <Number T>
std::optional<Ends<T>> ends_of(const CappedSpan<T>& s) {
    if (!is_certain(s.is_hit())) return std::nullopt;
    const T root = sqrt(s.side.q);
    const bool past = is_certain(s.side.h > T(0));
    const auto one_of = [](const auto& by_cap, const Fraction<T>& cap, const T& at_root) -> std::optional<T> {
        if (is_certain(by_cap)) return cap.n / cap.m;
        return is_certain(!by_cap) ? std::optional(at_root) : std::nullopt;
    };
    const auto near =
        one_of(s.enters_by_cap(), s.entry, past ? -(root + s.side.h) / s.side.a : s.side.c / (root - s.side.h));
    const auto far =
        one_of(s.leaves_by_cap(), s.exit, past ? -s.side.c / (root + s.side.h) : (root - s.side.h) / s.side.a);
    return near && far ? std::optional(Ends<T>{*near, *far}) : std::nullopt;
}

}  // namespace lostbits
