// The part of a line inside a quadric surface with two planes as caps, over any number: cylinders and cones.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// The t between two parallel planes, from `planes_entry` to `planes_exit`, at which P(t) = a t² + 2 h t + c ≤ 0. The
/// primitive is convex, so these t form one interval, although `a` may have any sign. If P < 0 beyond both roots (a <
/// 0: a line steeper than a cone, which also meets the mirror image of the cone), one of the two parts lies between the
/// planes. The line enters by the plane at `planes_entry` if P ≤ 0 there; otherwise it enters where P falls through 0,
/// at (−h − √q)/a. Likewise it leaves by the plane at `planes_exit`, or where P rises through 0, at (−h + √q)/a. All
/// these decisions use P and half of its slope at the planes, so no decision takes a root.
///
/// For a line parallel to the planes, `planes_entry` is −1/0, `planes_exit` is 1/0, and a > 0.
template <class T>
struct CappedSpan {
    QuadraticSpan<T> side;
    Fraction<T> planes_entry, planes_exit;
    QuadraticAt<T> at_planes_entry, at_planes_exit;
    mask_t<T> crosses_planes;      ///< the line crosses the planes
    mask_t<T> passes_closed_slab;  ///< the line crosses the planes, or is parallel to them and lies between or on them
    mask_t<T> passes_open_slab;  ///< the line crosses the planes, or is parallel to them and lies strictly between them
    T d2;                        ///< d·d

    static constexpr bool may_hit_beyond_touch = false;

    /// True if some point of the line lies in the closed primitive. It is enough to test the points at the planes and
    /// at the minimum of P.
    [[nodiscard]] mask_t<T> meets_closed() const {
        const T zero(0);
        const auto meets_quadric = side.q >= zero;
        const auto is_met = enters_by_cap() || leaves_by_cap() || (has_minimum_between_planes() && meets_quadric);
        return passes_closed_slab && ((crosses_planes && is_met) || (!crosses_planes && meets_quadric));
    }
    /// True if some point of the line lies in the open primitive.
    [[nodiscard]] mask_t<T> meets_open() const {
        const T zero(0);
        const auto meets_quadric = side.q > zero;
        const auto is_met = at_planes_entry.value < zero || at_planes_exit.value < zero ||
                            (has_minimum_between_planes() && meets_quadric);
        return passes_open_slab && ((crosses_planes && is_met) || (!crosses_planes && meets_quadric));
    }
    /// Compares the entry of a line that meets the closed primitive with t: `less` if the line enters before t,
    /// `at_most` if it enters at t or before.
    ///
    /// The hard case is a t past the first plane with P(t) > 0. The line has then left the primitive if it entered
    /// through the plane, or if t is past the minimum of P (a > 0). Otherwise it has not entered yet.
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> compare_entry(const At& t) const {
        const T zero(0);
        const auto entry_order = order_of(planes_entry, t);
        const auto& [value, half_slope] = quadratic_at(side, t);
        const auto opens_upwards = side.a > zero, by_cap = crosses_planes && enters_by_cap();
        return {
            (!crosses_planes || entry_order.less) && (by_cap || value < zero || (opens_upwards && half_slope > zero)),
            (!crosses_planes || entry_order.at_most) &&
                (by_cap || value <= zero || (opens_upwards && half_slope >= zero))};
    }
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> compare_exit(const At& t) const {
        const T zero(0);
        const auto entry_order = order_of(planes_entry, t), exit_order = order_of(planes_exit, t);
        const auto& [value, half_slope] = quadratic_at(side, t);
        const auto opens_upwards = side.a > zero, by_cap = crosses_planes && enters_by_cap(), is_outside = value > zero;
        const auto has_left = is_outside && ((opens_upwards && half_slope > zero) || (by_cap && entry_order.less));
        const auto has_left_by_now =
            value >= zero && ((opens_upwards && half_slope >= zero) ||
                              (by_cap && entry_order.at_most && (is_outside || half_slope > zero)));
        return {has_left || (crosses_planes && exit_order.less),
                has_left_by_now || (crosses_planes && exit_order.at_most)};
    }
    /// For a line that meets the closed primitive: true if it enters (`enters_by_cap`) or leaves (`leaves_by_cap`)
    /// through a plane. At a rim, both answers are right.
    [[nodiscard]] mask_t<T> enters_by_cap() const { return crosses_planes && at_planes_entry.value <= T(0); }
    [[nodiscard]] mask_t<T> leaves_by_cap() const { return crosses_planes && at_planes_exit.value <= T(0); }

private:
    [[nodiscard]] mask_t<T> has_minimum_between_planes() const {
        return at_planes_entry.half_slope < T(0) && at_planes_exit.half_slope > T(0);
    }
};

/// Builds the span for the planes v·(p − base) = 0 and v·(p − base) = v². `v_dot_f` is v·(o − base), `v_dot_d` is v·d,
/// and `v2` is v².
template <class T>
CappedSpan<T> make_capped_span(const QuadraticSpan<T>& side, const T& v_dot_f, const T& v_dot_d, const T& v2) {
    const T zero(0), one(1);
    const auto is_upward = v_dot_d > zero, crosses_planes = is_upward || v_dot_d < zero;
    const T magnitude = select(is_upward, v_dot_d, -v_dot_d);
    const Fraction<T> to_base{-v_dot_f, magnitude}, to_top{v2 - v_dot_f, magnitude}, from_top{-to_top.n, magnitude},
        from_base{v_dot_f, magnitude};
    const Fraction<T> minus_infinity{-one, zero}, plus_infinity{one, zero};
    const Fraction<T> planes_entry = select(crosses_planes, select(is_upward, to_base, from_top), minus_infinity);
    const Fraction<T> planes_exit = select(crosses_planes, select(is_upward, to_top, from_base), plus_infinity);
    return {.side = side,
            .planes_entry = planes_entry,
            .planes_exit = planes_exit,
            .at_planes_entry = quadratic_at(side, planes_entry),
            .at_planes_exit = quadratic_at(side, planes_exit),
            .crosses_planes = crosses_planes,
            .passes_closed_slab = crosses_planes || (v_dot_f >= zero && v_dot_f <= v2),
            .passes_open_slab = crosses_planes || (v_dot_f > zero && v_dot_f < v2),
            .d2 = side.d2};
}

/// Entry and exit of a line. Returns nothing if it is not known by which surface the line enters or leaves.
template <Number T>
std::optional<Ends<T>> ends_of(const CappedSpan<T>& span) {
    if (!is_certain(span.meets_closed())) return std::nullopt;
    const T root = sqrt(span.side.q);
    const bool is_h_positive = is_certain(span.side.h > T(0));
    const auto end_by = [](const auto& by_cap, const Fraction<T>& cap, const T& at_root) -> std::optional<T> {
        if (is_certain(by_cap)) return cap.n / cap.m;
        return is_certain(!by_cap) ? std::optional(at_root) : std::nullopt;
    };
    const auto near = end_by(span.enters_by_cap(), span.planes_entry,
                             is_h_positive ? -(root + span.side.h) / span.side.a : span.side.c / (root - span.side.h));
    const auto far = end_by(span.leaves_by_cap(), span.planes_exit,
                            is_h_positive ? -span.side.c / (root + span.side.h) : (root - span.side.h) / span.side.a);
    return near && far ? std::optional(Ends<T>{*near, *far}) : std::nullopt;
}

}  // namespace lostbits
