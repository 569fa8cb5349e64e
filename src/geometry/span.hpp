// The part of a line o + t d inside a primitive, over any number. The truth of every shape is built from spans. A shape
// chooses one of the span types and sets its coefficients. The span decides if and where the line meets the shape.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "geometry/range.hpp"
#include "geometry/vec.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// True if a mask is certain to hold. For numbers whose comparisons are always decided, this is the mask itself.
inline constexpr bool is_certain(bool mask) { return mask; }
inline constexpr bool is_certain(Tri mask) { return mask.is_yes(); }

/// Calls `visit(i)` for each axis, with i a constant: in a loop, packs would go through memory.
template <class Visit>
constexpr void for_each_axis(const Visit& visit) {
    visit(std::integral_constant<int, 0>{}), visit(std::integral_constant<int, 1>{}),
        visit(std::integral_constant<int, 2>{});
}

/// The t at which a t² + 2 h t + c ≤ 0: between (−h ∓ √q)/a, with q = h² − a c computed by the expression that cancels
/// least. The surface is c(o) = 0; `a` is positive.
template <class T>
struct QuadraticSpan {
    T h, c, a, q;
    T d2;  ///< d·d

    /// True if a ray that only touches the surface may meet it again beyond that point. Every span defines this
    /// constant.
    static constexpr bool may_hit_beyond_touch = false;
};

/// Compares a b with c d. Number types that can compare products more cheaply overload this function.
template <Number T>
Order<mask_t<T>> order_of_products(const T& a, const T& b, const T& c, const T& d) {
    const T x = a * b, y = c * d;
    return {x < y, x <= y};
}

/// t = 0, where a ray begins. Comparisons with it need no product.
struct ZeroParameter {};

/// The fraction n/m, m ≥ 0. Fractions are compared by n₁ m₂ and n₂ m₁: for equal fractions these products are the same
/// number at some precision, which need not be true of the quotients.
template <class T>
struct Fraction {
    T n;
    T m;

    friend Order<mask_t<T>> order_of(const Fraction& a, const Fraction& b) {
        return order_of_products(a.n, b.m, b.n, a.m);
    }
    friend Order<mask_t<T>> order_of(const Fraction& a, ZeroParameter) { return {a.n < T(0), a.n <= T(0)}; }
    friend Fraction select(const mask_t<T>& mask, const Fraction& a, const Fraction& b) {
        return {select(mask, a.n, b.n), select(mask, a.m, b.m)};
    }
};

/// The part of the line inside all slabs: from the largest `entry` to the smallest `exit`. A slab that the line does
/// not cross has the entry −1/0 and the exit 1/0. `closed` and `open` are the conditions that do not depend on t.
template <class T>
struct SlabSpan {
    std::array<Fraction<T>, 3> entry, exit;
    std::array<mask_t<T>, 3> crossed;
    mask_t<T> closed;  ///< o lies in each slab that the line does not cross
    mask_t<T> open;    ///< o lies in each open slab that the line does not cross, and every slab has thickness
    T d2;              ///< d·d

    static constexpr bool may_hit_beyond_touch = false;
};

/// A range of t as fractions, for comparisons with spans; the range of a ray is `Range`. If it has no end, `end` is
/// 1/0.
template <class T>
struct SpanRange {
    T begin;
    Fraction<T> end;
    OpenEnds open_ends;
};

/// True if a point lies before the end of a range, or at a closed end. `to_end` is the comparison of the point with
/// that end.
template <class Mask, class T>
Mask is_before_range_end(const Order<Mask>& to_end, const SpanRange<T>& range) {
    return range.open_ends.tmax ? to_end.less : to_end.at_most;
}

/// The polynomial P(t) = a t² + 2 h t + c at t = n/m, multiplied by m² to avoid divisions; and half of its slope,
/// multiplied by m.
template <class T>
struct QuadraticAt {
    T value, half_slope;

    /// Compares the roots, if there are any, with t. The near root comes before t if P(t) < 0 or the slope is positive;
    /// the far root comes before t if both P(t) and the slope are positive. The same holds with equality included.
    [[nodiscard]] Order<mask_t<T>> order_of_near_root() const {
        const T zero(0);
        return {value < zero || half_slope > zero, value <= zero || half_slope >= zero};
    }
    [[nodiscard]] Order<mask_t<T>> order_of_far_root() const {
        const T zero(0);
        return {value > zero && half_slope > zero, value >= zero && half_slope >= zero};
    }
};
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& span, const T& t) {
    const T half_slope = span.a * t + span.h;
    return {(half_slope + span.h) * t + span.c, half_slope};
}
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& span, ZeroParameter) {
    return {span.c, span.h};
}
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& span, const Fraction<T>& t) {
    const T h = span.h * t.m, half_slope = span.a * t.n + h;
    return {(half_slope + h) * t.n + span.c * square(t.m), half_slope};
}

/// `closed`: true if some t of a range lies in the closed primitive; `open`: true if some t lies in the open primitive.
/// Let a be the largest entry and b the smallest exit. The line is in the closed primitive for a ≤ t ≤ b and in the
/// open one for a < t < b. For a range that holds some t:
///     closed:  a ≤ b,  tmin ≤ b,  a ≤ tmax          open:  a < b,  tmin < b,  a < tmax
/// At an open end, `closed` has < as well. (With tmax = 0, a < tmax then says that the origin is inside.) Entry and
/// exit of one axis are in the order of lo and hi.
template <class T>
struct SlabHit {
    mask_t<T> closed, open;
};

/// Decides for the range of all t ≥ 0. a ≤ b holds if and only if every entry is ≤ every exit, so a and b are not
/// computed.
template <class T>
SlabHit<T> slab_hit(const SlabSpan<T>& span) {
    const T zero(0);
    SlabHit<T> result{span.closed, span.open};
    for_each_axis([&](auto i) {
        result.closed = result.closed && zero <= span.exit[i].n;
        result.open = result.open && zero < span.exit[i].n;
        for_each_axis([&](auto j) {
            if constexpr (i != j) {
                const auto order = order_of(span.entry[i], span.exit[j]);
                const auto are_parallel = !(span.crossed[i] || span.crossed[j]);
                result.closed = result.closed && (are_parallel || order.at_most);
                result.open = result.open && (are_parallel || order.less);
            }
        });
    });
    result.open = result.closed && result.open;
    return result;
}

/// Decides for a range. In the same way, compares `tmin` with every exit and every entry with `tmax`.
template <class T>
SlabHit<T> slab_hit(const SlabSpan<T>& span, const SpanRange<T>& range) {
    SlabHit<T> result = slab_hit(span);
    for_each_axis([&](auto i) {
        const auto begin_to_exit = order_of(Fraction<T>{range.begin, T(1)}, span.exit[i]),
                   entry_to_end = order_of(span.entry[i], range.end);
        const auto is_parallel = !span.crossed[i];
        result.closed =
            result.closed && (is_parallel || ((range.open_ends.tmin ? begin_to_exit.less : begin_to_exit.at_most) &&
                                              is_before_range_end(entry_to_end, range)));
        result.open = result.open && (is_parallel || (begin_to_exit.less && entry_to_end.less));
    });
    result.open = result.closed && result.open;
    return result;
}

/// Largest entry, or 0/1 if no entry is positive. Of equal entries, returns the first.
template <class T>
Fraction<T> largest_entry(const SlabSpan<T>& span) {
    const T zero(0);
    const auto is_positive = [&](const Fraction<T>& entry) { return entry.n > zero; };
    Fraction<T> largest = select(is_positive(span.entry[0]), span.entry[0], Fraction<T>{zero, T(1)});
    const auto take_larger = [&](const Fraction<T>& entry) {
        largest = select(is_positive(entry) && order_of(largest, entry).less, entry, largest);
    };
    take_larger(span.entry[1]);
    take_larger(span.entry[2]);
    return largest;
}

/// Largest entry, or the beginning of the range if no entry is later. Of equal entries, returns the first.
template <class T>
Fraction<T> largest_entry(const SlabSpan<T>& span, const SpanRange<T>& range) {
    Fraction<T> largest{range.begin, T(1)};
    for_each_axis([&](auto i) { largest = select(order_of(largest, span.entry[i]).less, span.entry[i], largest); });
    return largest;
}

/// True if every entry comes before the beginning of the range (`less`), or no later (`at_most`).
template <class T>
Order<mask_t<T>> compare_entries_with_begin(const SlabSpan<T>& span, const SpanRange<T>& range) {
    const auto to_begin = [&](const Fraction<T>& entry) { return order_of(entry, Fraction<T>{range.begin, T(1)}); };
    const auto x = to_begin(span.entry[0]), y = to_begin(span.entry[1]), z = to_begin(span.entry[2]);
    return {x.less && y.less && z.less, x.at_most && y.at_most && z.at_most};
}

/// Smallest exit. Of equal exits, returns the first.
template <Number T>
Fraction<T> smallest_exit(const SlabSpan<T>& span) {
    Fraction<T> smallest = span.exit[0];
    for (const Fraction<T>& exit : span.exit) smallest = select(order_of(exit, smallest).less, exit, smallest);
    return smallest;
}

/// A span of a primitive with an inside. It says whether the line meets the closed primitive and whether it meets the
/// open one, and compares the entry and the exit of the line with a fraction.
template <class S, class T>
concept ComparableSpan = requires(const S& s, const Fraction<T>& t) {
    s.meets_closed(), s.meets_open(), s.compare_entry(t), s.compare_exit(t);
};

/// Entry and exit of a line: near ≤ far if it meets the primitive.
template <class T>
struct Ends {
    T near, far;
};

template <Number T>
std::optional<Ends<T>> ends_of(const QuadraticSpan<T>& span) {
    const T root = sqrt(span.q);
    return Ends<T>{(-span.h - root) / span.a, (root - span.h) / span.a};
}

/// Largest entry and smallest exit. If it is not known which of two enclosures is the larger, they are joined. Returns
/// nothing if the line is parallel to all slabs, or may lie outside a slab that it is parallel to.
template <Number T>
std::optional<Ends<T>> ends_of(const SlabSpan<T>& span) {
    std::optional<Ends<T>> ends;
    if (!is_certain(span.closed)) return ends;
    for (std::size_t i = 0; i < span.entry.size(); ++i) {
        if (is_certain(!span.crossed[i])) continue;
        const T entry_t = span.entry[i].n / span.entry[i].m, exit_t = span.exit[i].n / span.exit[i].m;
        ends = ends ? Ends<T>{max(ends->near, entry_t), min(ends->far, exit_t)} : Ends<T>{entry_t, exit_t};
    }
    return ends;
}

}  // namespace lostbits
