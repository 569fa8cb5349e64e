// Where a line o + t d is inside of a solid, over any number: what the truth of every shape is made from. A shape says
// which of these its span is and what stands in it; all that is asked of one is asked of these.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "geometry/range.hpp"
#include "geometry/vec.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Whether a mask is certain to hold; of a number that always tells, whether it holds.
inline constexpr bool is_certain(bool mask) { return mask; }
inline constexpr bool is_certain(Tri mask) { return mask.is_yes(); }

/// `act(i)` for each axis, with i a constant: the packs of a loop would go through memory.
template <class Act>
constexpr void for_each_axis(const Act& act) {
    act(std::integral_constant<int, 0>{}), act(std::integral_constant<int, 1>{}), act(std::integral_constant<int, 2>{});
}

/// Those t at which a t² + 2 h t + c ≤ 0: between (−h ∓ √q)/a, with q = h² − a c in the form that subtracts least. What
/// is met is the surface, c(o) = 0. `a` is positive.
template <class T>
struct QuadraticSpan {
    T h, c, a, q;
    T d2;  ///< d·d

    /// Whether a ray that only touches it may meet it behind that. Every span says so of itself.
    static constexpr bool is_met_behind_touch = false;
};

/// a b against c d. Numbers that know a shorter way have their own.
template <Number T>
Order<mask_t<T>> order_of_products(const T& a, const T& b, const T& c, const T& d) {
    const T x = a * b, y = c * d;
    return {x < y, x <= y};
}

/// t = 0, where a ray begins: what is asked of it takes no product.
struct Start {};

/// n/m, m ≥ 0. Fractions are compared by n₁ m₂ against n₂ m₁: of equal fractions these become the same number at some
/// precision, which the quotients need not.
template <class T>
struct Fraction {
    T n;
    T m;

    friend Order<mask_t<T>> order_of(const Fraction& a, const Fraction& b) {
        return order_of_products(a.n, b.m, b.n, a.m);
    }
    friend Order<mask_t<T>> order_of(const Fraction& a, Start) { return {a.n < T(0), a.n <= T(0)}; }
    friend Fraction select(const mask_t<T>& mask, const Fraction& a, const Fraction& b) {
        return {select(mask, a.n, b.n), select(mask, a.m, b.m)};
    }
};

/// What slabs leave of the line: those t that are at least every `entry` and at most every `exit`. A slab that the line
/// does not cross has −1/0 and 1/0 there. And what no t changes, for the closed and the open solid.
template <class T>
struct SlabSpan {
    std::array<Fraction<T>, 3> entry, exit;
    std::array<mask_t<T>, 3> crossed;
    mask_t<T> closed;  ///< o lies in each slab that the line does not cross
    mask_t<T> open;    ///< o lies in the open one, and no slab is without thickness
    T d2;              ///< d·d

    static constexpr bool is_met_behind_touch = false;
};

/// A range as spans are held against it: its end is 1/0 where it has none.
template <class T>
struct RangeOfSpan {
    T begin;
    Fraction<T> end;
    OpenEnds open;
};

/// Whether what stands so to the end of a range is in it.
template <class Mask, class T>
Mask in_time(const Order<Mask>& to_end, const RangeOfSpan<T>& range) {
    return range.open.tmax ? to_end.less : to_end.at_most;
}

/// P(t) = a t² + 2 h t + c and a t + h, half of its slope, at t = n/m, times m² and m.
template <class T>
struct QuadraticAt {
    T value, slope;

    /// How the roots stand to t where there are any: the near one comes before t where P(t) < 0 or the slope is
    /// positive, the far one where P(t) and the slope are; and so on with equality.
    [[nodiscard]] Order<mask_t<T>> near_root() const {
        const T zero(0);
        return {value < zero || slope > zero, value <= zero || slope >= zero};
    }
    [[nodiscard]] Order<mask_t<T>> far_root() const {
        const T zero(0);
        return {value > zero && slope > zero, value >= zero && slope >= zero};
    }
};
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& s, const T& t) {
    const T slope = s.a * t + s.h;
    return {(slope + s.h) * t + s.c, slope};
}
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& s, Start) {
    return {s.c, s.h};
}
template <class T>
QuadraticAt<T> quadratic_at(const QuadraticSpan<T>& s, const Fraction<T>& t) {
    const T h = s.h * t.m, slope = s.a * t.n + h;
    return {(slope + h) * t.n + s.c * square(t.m), slope};
}

/// Whether some t of a range lies in the closed and in the open solid. With a the largest entry and b the smallest
/// exit, the line is in the closed solid for a ≤ t ≤ b and in the open one for a < t < b, so that for a range that
/// holds any t
///     closed:  a ≤ b,  tmin ≤ b,  a ≤ tmax          open:  a < b,  tmin < b,  a < tmax
/// with < of the closed one too at an end that is open (where a < 0 = tmax the origin is inside). Each inequality
/// between a largest and a smallest is the conjunction of those between all, so neither needs to be known; entry and
/// exit of one axis are in the order of lo and hi.
template <class T>
struct InSlabs {
    mask_t<T> closed, open;
};

/// Of all that lies ahead.
template <class T>
InSlabs<T> in_slabs(const SlabSpan<T>& s) {
    const T zero(0);
    InSlabs<T> in{s.closed, s.open};
    for_each_axis([&](auto i) {
        in.closed = in.closed && zero <= s.exit[i].n;
        in.open = in.open && zero < s.exit[i].n;
        for_each_axis([&](auto j) {
            if constexpr (i != j) {
                const auto order = order_of(s.entry[i], s.exit[j]);
                const auto still = !(s.crossed[i] || s.crossed[j]);
                in.closed = in.closed && (still || order.at_most);
                in.open = in.open && (still || order.less);
            }
        });
    });
    in.open = in.closed && in.open;
    return in;
}

template <class T>
InSlabs<T> in_slabs(const SlabSpan<T>& s, const RangeOfSpan<T>& range) {
    InSlabs<T> in = in_slabs(s);
    for_each_axis([&](auto i) {
        const auto begun = order_of(Fraction<T>{range.begin, T(1)}, s.exit[i]), ended = order_of(s.entry[i], range.end);
        const auto still = !s.crossed[i];
        in.closed = in.closed && (still || ((range.open.tmin ? begun.less : begun.at_most) && in_time(ended, range)));
        in.open = in.open && (still || (begun.less && ended.less));
    });
    in.open = in.closed && in.open;
    return in;
}

/// The largest entry, or 0/1 where none is positive; of equal ones the first.
template <class T>
Fraction<T> first_entry(const SlabSpan<T>& s) {
    const T zero(0);
    const auto positive = [&](const Fraction<T>& entry) { return entry.n > zero; };
    Fraction<T> first = select(positive(s.entry[0]), s.entry[0], Fraction<T>{zero, T(1)});
    const auto next = [&](const Fraction<T>& entry) {
        first = select(positive(entry) && order_of(first, entry).less, entry, first);
    };
    next(s.entry[1]), next(s.entry[2]);
    return first;
}

/// The largest entry, or where the range begins where none comes later; of equal ones the first.
template <class T>
Fraction<T> first_entry(const SlabSpan<T>& s, const RangeOfSpan<T>& range) {
    Fraction<T> first{range.begin, T(1)};
    for_each_axis([&](auto i) { first = select(order_of(first, s.entry[i]).less, s.entry[i], first); });
    return first;
}

/// Whether every entry comes before the range begins, or no later.
template <class T>
Order<mask_t<T>> entries_to_begin(const SlabSpan<T>& s, const RangeOfSpan<T>& range) {
    const auto to_begin = [&](const Fraction<T>& entry) { return order_of(entry, Fraction<T>{range.begin, T(1)}); };
    const auto x = to_begin(s.entry[0]), y = to_begin(s.entry[1]), z = to_begin(s.entry[2]);
    return {x.less && y.less && z.less, x.at_most && y.at_most && z.at_most};
}

/// The smallest exit; of equal ones the first.
template <Number T>
Fraction<T> first_exit(const SlabSpan<T>& s) {
    Fraction<T> first = s.exit[0];
    for (const Fraction<T>& exit : s.exit) first = select(order_of(exit, first).less, exit, first);
    return first;
}

/// A span of a solid that tells whether the line meets it (the closed and the open one), and how entering and leaving
/// stand to a fraction.
template <class S, class T>
concept ToldSpan = requires(const S& s, const Fraction<T>& t) {
    s.is_met(), s.is_open(), s.enters_to(t), s.leaves_to(t);
};

/// Where a line enters and leaves: near ≤ far where it meets the solid.
template <class T>
struct Ends {
    T near, far;
};

template <Number T>
std::optional<Ends<T>> ends_of(const QuadraticSpan<T>& s) {
    const T root = sqrt(s.q);
    return Ends<T>{(-s.h - root) / s.a, (root - s.h) / s.a};
}

/// The largest entry and the smallest exit, of two that cannot be told apart both; nothing where no slab is crossed,
/// or where the line is not known to be in each of the others.
template <Number T>
std::optional<Ends<T>> ends_of(const SlabSpan<T>& s) {
    std::optional<Ends<T>> ends;
    if (!is_certain(s.closed)) return ends;
    for (std::size_t i = 0; i < s.entry.size(); ++i) {
        if (is_certain(!s.crossed[i])) continue;
        const T in = s.entry[i].n / s.entry[i].m, out = s.exit[i].n / s.exit[i].m;
        ends = ends ? Ends<T>{max(ends->near, in), min(ends->far, out)} : Ends<T>{in, out};
    }
    return ends;
}

}  // namespace lostbits
