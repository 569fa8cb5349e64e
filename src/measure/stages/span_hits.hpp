// Finds the first t at which a ray meets a primitive, for many rays at once, from the interval in which the line is
// inside the primitive (geometry/span.hpp). The numbers carry their error bounds, so no lemma about rounding is needed.
#pragma once

#include <array>
#include <limits>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/recorded_root.hpp"
#include "geometry/span.hpp"
#include "geometry/wall_span.hpp"
#include "number/wide/recorded_running_error.hpp"

namespace lostbits::measure::stages {

using number::wide::ColumnMask;
using number::wide::ColumnWord;
using number::wide::is_unset;
using number::wide::RunningError;

/// First t at which a ray meets a closed primitive. `hit` or `missed` is set if it is proved that the closed and the
/// open primitive both have this answer. If `at_origin` is set too, t* is 0 and `t` is not used.
template <class E>
struct SpanHit {
    mask_t<typename E::P> hit, missed, at_origin;
    E t;
};

/// Near root of a quadratic: c/(−h + √q), or −(h + √q)/a if h > 0 (`is_h_positive`). If `far`, the far root: (−h +
/// √q)/a, or −c/(h + √q) if h > 0. If the sign of h is not proved, both expressions are valid.
template <class E>
Fraction<E> fraction_of_root(const QuadraticSpan<E>& span, const mask_t<typename E::P>& far,
                             const mask_t<typename E::P>& is_h_positive) {
    const auto divides_by_a = (far && !is_h_positive) || (is_h_positive && !far);
    const E sum = sqrt(span.q) + select(is_h_positive, span.h, -span.h), n = select(divides_by_a, sum, span.c);
    return {select(is_h_positive, -n, n), select(divides_by_a, span.a, sum)};
}
template <class E>
E root_of(const QuadraticSpan<E>& span, const mask_t<typename E::P>& far, const mask_t<typename E::P>& is_h_positive) {
    const Fraction<E> root = fraction_of_root(span, far, is_h_positive);
    return root.n / root.m;
}

/// Tests whether an entry lies in the range, for both the closed and the open primitive, from the order of the entry
/// relative to the end of the range. A ray that ends at the entry touches the primitive.
template <class Mask, class T>
Mask entry_in_time(const Order<Mask>& to_end, const SpanRange<T>& range) {
    return {to_end.less.yes(), is_before_range_end(to_end, range).no()};
}

/// Answer of `truth::enclose` for the usual convention.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const QuadraticSpan<RunningError<W>>& span) {
    using E = RunningError<W>;
    using P = typename E::P;
    const E zero(0);
    const auto outside = span.c > zero;
    const auto inside = span.c < zero;
    const auto is_h_positive = span.h > zero;
    const auto hit = (span.q > zero).yes() && (inside.yes() || (outside.yes() && (span.h < zero).yes()));
    const auto missed = outside.yes() && ((span.h >= zero).yes() || (span.q < zero).yes()), no_lane = P(0) < P(0);
    if (is_unset(hit)) return {hit, missed, no_lane, zero};
    return {hit, missed, no_lane, root_of(span, inside.yes(), is_h_positive.yes())};
}

/// Answer of `truth::enclose` for a ray with a range.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const QuadraticSpan<RunningError<W>>& span,
                                        const SpanRange<RunningError<W>>& range) {
    using E = RunningError<W>;
    using P = typename E::P;
    const E zero(0);
    const auto begin = quadratic_at(span, range.begin), end = quadratic_at(span, range.end);
    const auto outside = begin.value > zero, inside = begin.value < zero;
    const auto near_in_range = entry_in_time(end.order_of_near_root(), range),
               far_in_range = is_before_range_end(end.order_of_far_root(), range);
    const auto hits_far = inside.yes() && far_in_range.yes();
    const auto hits_near = outside.yes() && (begin.half_slope < zero).yes() && near_in_range.yes();
    const auto hit = (span.q > zero).yes() && (hits_near || hits_far);
    const auto missed =
        (outside.yes() && ((begin.half_slope >= zero).yes() || (span.q < zero).yes() || near_in_range.no())) ||
        (inside.yes() && far_in_range.no());
    const auto no_lane = P(0) < P(0);
    if (is_unset(hit)) return {hit, missed, no_lane, zero};
    return {hit, missed, no_lane, root_of(span, hits_far, (span.h > zero).yes())};
}

/// Order of x and y, each of which may be off by 2^-44 of itself plus half of `least`.
template <class P>
Order<TriMask<mask_t<P>>> certain_order(const P& x, const P& y, const P& least) {
    using lostbits::abs;
    const P d = x - y, e = P(0x1p-43) * (abs(x) + abs(y)) + least, low = d - e, high = d + e;
    return {{high < P(0), low >= P(0)}, {high <= P(0), low > P(0)}};
}
inline Order<TriMask<ColumnMask>> certain_order(const ColumnWord& x, const ColumnWord& y, const ColumnWord& least) {
    return order_of_first_words(x, y, least);
}

/// A number that is compared by its first word, which is known to 2^-45 of itself. That suffices for nearly all rays,
/// with transforms too.
///
/// The rounded products x = a b and y = c d of such numbers are off by at most 2.1·2^-45 of themselves plus 2^-1074,
/// and x − y by 2^-53 more: a b < c d if x − y < −(2^-43 (|x| + |y|) + 2^-1000), and so on.
///
/// If a selection is undecided, the word is NaN, which leaves every comparison undecided: if the products of two
/// entries are both below 2^-1000, the larger entry is unknown, and each of the two may be far from it.
template <class W>
struct ByFirstWord {
    using P = typename RunningError<W>::P;
    using Mask = TriMask<mask_t<P>>;

    RunningError<W> whole;

    ByFirstWord() = default;
    explicit ByFirstWord(int x) : whole(x) {}
    explicit ByFirstWord(const RunningError<W>& x) : whole(x) {}

    friend Order<Mask> order_of_products(const ByFirstWord& a, const ByFirstWord& b, const ByFirstWord& c,
                                         const ByFirstWord& d) {
        return certain_order(a.whole.first() * b.whole.first(), c.whole.first() * d.whole.first(), P(0x1p-1000));
    }
    friend Mask operator<(const ByFirstWord& a, const ByFirstWord& b) { return order_of(a, b).less; }
    friend Mask operator<=(const ByFirstWord& a, const ByFirstWord& b) { return order_of(a, b).at_most; }
    friend Mask operator>(const ByFirstWord& a, const ByFirstWord& b) { return order_of(b, a).less; }
    friend Mask operator>=(const ByFirstWord& a, const ByFirstWord& b) { return order_of(b, a).at_most; }
    friend ByFirstWord select(const Mask& mask, const ByFirstWord& a, const ByFirstWord& b) {
        const RunningError<W> undecided(W(P(std::numeric_limits<double>::quiet_NaN())));
        return ByFirstWord(select(mask.yes() || mask.no(), select(mask.yes(), a.whole, b.whole), undecided));
    }

private:
    static Order<Mask> order_of(const ByFirstWord& a, const ByFirstWord& b) {
        return certain_order(a.whole.first(), b.whole.first(), P(0));
    }
};

/// Slabs in numbers that are compared by their first word. `is_precise` is set if all first words are good to 2^-45 of
/// themselves.
template <class W>
struct QuickSlabs {
    SlabSpan<ByFirstWord<W>> span;
    mask_t<typename RunningError<W>::P> is_precise;
};
template <class W>
QuickSlabs<W> to_quick_slabs(const SlabSpan<RunningError<W>>& span) {
    using E = RunningError<W>;
    using P = typename E::P;
    using lostbits::abs;
    using Quick = ByFirstWord<W>;
    QuickSlabs<W> slabs{
        {.entry = {}, .exit = {}, .crossed = span.crossed, .closed = span.closed, .open = span.open, .d2 = {}},
        P(0) <= P(0)};
    const auto to_quick = [&slabs](const E& x) {
        slabs.is_precise =
            slabs.is_precise && x.radius() <= P(0x1p-46) * abs(x.first());  // and the second word is smaller
        return Quick(x);
    };
    for_each_axis([&](auto i) {
        const Quick m = to_quick(span.entry[i].m);
        slabs.span.entry[i] = {to_quick(span.entry[i].n), m};
        slabs.span.exit[i] = {to_quick(span.exit[i].n), m};
    });
    return slabs;
}

/// Answer of `truth::enclose` for the usual convention. If a first word is not good to 2^-45 of itself, no decision
/// is proved.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const SlabSpan<RunningError<W>>& span) {
    using E = RunningError<W>;
    using Quick = ByFirstWord<W>;
    const auto [slabs, is_precise] = to_quick_slabs(span);
    const SlabHit<Quick> in = slab_hit(slabs);
    const Fraction<Quick> entry = largest_entry(slabs);
    const auto at_origin = (entry.n <= Quick(0)).yes(), hit = is_precise && in.open.yes(),
               missed = is_precise && in.closed.no();
    const E one(1);
    if (is_unset(hit)) return {hit, missed, at_origin, one};
    return {hit, missed, at_origin, select(at_origin, one, entry.n.whole) / select(at_origin, one, entry.m.whole)};
}

/// Answer of `truth::enclose` for a ray with a range.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const SlabSpan<RunningError<W>>& span,
                                        const SpanRange<RunningError<W>>& range) {
    using E = RunningError<W>;
    using Quick = ByFirstWord<W>;
    const auto [slabs, is_precise] = to_quick_slabs(span);
    const SpanRange<Quick> quick_range{Quick(range.begin), {Quick(range.end.n), Quick(range.end.m)}, range.open_ends};
    const SlabHit<Quick> in = slab_hit(slabs, quick_range);
    const Fraction<Quick> entry = largest_entry(slabs, quick_range);
    const auto at_begin = compare_entries_with_begin(slabs, quick_range).at_most.yes();
    const auto at_origin = at_begin && (range.begin <= E(0)).yes();
    const auto hit = is_precise && in.open.yes(), missed = is_precise && in.closed.no();
    const E one(1);
    if (is_unset(hit)) return {hit, missed, at_origin, one};
    const E t = select(at_begin, one, entry.n.whole) / select(at_begin, one, entry.m.whole);
    return {hit, missed, at_origin, select(at_begin, range.begin, t)};
}

/// Answer of `truth::enclose` for the usual convention, if the ray meets neither the rim nor the surface at its
/// origin.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const FlatSpan<RunningError<W>>& span) {
    using P = typename RunningError<W>::P;
    const RunningError<W> zero(0), one(1);
    const auto hit = span.open.yes() && (span.at.n > zero).yes(), no_lane = P(0) < P(0);
    const auto missed = span.closed.no() || (span.at.n < zero).yes();
    if (is_unset(hit)) return {hit, missed, no_lane, zero};
    return {hit, missed, no_lane, span.at.n / select(hit, span.at.m, one)};
}

/// Answer of `truth::enclose` for a ray with a range that does not begin on the surface.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const FlatSpan<RunningError<W>>& span,
                                        const SpanRange<RunningError<W>>& range) {
    using P = typename RunningError<W>::P;
    const RunningError<W> zero(0), one(1);
    const auto to_begin = order_of(span.at, Fraction<RunningError<W>>{range.begin, one});
    const auto before_end = is_before_range_end(order_of(span.at, range.end), range);
    const auto hit = span.open.yes() && to_begin.at_most.no() && before_end.yes(), no_lane = P(0) < P(0);
    const auto missed = span.closed.no() || to_begin.less.yes() || before_end.no();
    if (is_unset(hit)) return {hit, missed, no_lane, zero};
    return {hit, missed, no_lane, span.at.n / select(hit, span.at.m, one)};
}

/// Answer of `truth::enclose` for the usual convention, if the ray meets no rim: the near side if the ray is known
/// to meet it, and the far side if the ray is known not to meet the near one.
template <class E, class Begin>
SpanHit<E> first_span_hit_of_wall(const WallSpan<E>& span, const Begin& begin,
                                  const std::array<mask_t<E>, 2>& in_range) {
    using P = typename E::P;
    const auto no_lane = P(0) < P(0);
    std::array<mask_t<P>, 2> hits{no_lane, no_lane}, misses{no_lane, no_lane};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto crossing = span.crossing(static_cast<int>(i));
        const auto to_begin = span.compare_crossing(static_cast<int>(i), begin);
        hits[i] = crossing.open.yes() && to_begin.at_most.no() && in_range[i].yes();
        misses[i] = crossing.closed.no() || to_begin.less.yes() || in_range[i].no();
    }
    const auto hits_far = misses[0] && hits[1], hit = hits[0] || hits_far, missed = misses[0] && misses[1];
    if (is_unset(hit)) return {hit, missed, no_lane, E(1)};
    return {hit, missed, no_lane, root_of(span.primitive.side, hits_far, (span.primitive.side.h > E(0)).yes())};
}
template <class W>
SpanHit<RunningError<W>> first_span_hit(const WallSpan<RunningError<W>>& span) {
    using E = RunningError<W>;
    const auto always = E(0) <= E(0);
    return first_span_hit_of_wall<E>(span, ZeroParameter(), {always, always});
}

/// Answer of `truth::enclose` for a ray with a range.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const WallSpan<RunningError<W>>& span,
                                        const SpanRange<RunningError<W>>& range) {
    return first_span_hit_of_wall<RunningError<W>>(span, Fraction<RunningError<W>>{range.begin, RunningError<W>(1)},
                                                   {is_before_range_end(span.compare_crossing(0, range.end), range),
                                                    is_before_range_end(span.compare_crossing(1, range.end), range)});
}

/// The t at which the line enters (if `far`, leaves), in the lanes of a hit. `known` is set in the lanes in which this
/// t is known.
template <class E>
struct BoundaryHit {
    mask_t<typename E::P> known;
    E t;
};
template <class W>
BoundaryHit<RunningError<W>> find_boundary_hit(const CappedSpan<RunningError<W>>& span,
                                               const mask_t<typename RunningError<W>::P>& far) {
    using E = RunningError<W>;
    const auto near_cap = span.enters_by_cap(), far_cap = span.leaves_by_cap();
    const auto by_cap = (!far && near_cap.yes()) || (far && far_cap.yes());
    const auto by_side = (!far && near_cap.no()) || (far && far_cap.no());
    const Fraction<E> root = fraction_of_root(span.side, far, (span.side.h > E(0)).yes());
    return {by_cap || by_side, select(by_cap, select(far, span.planes_exit.n, span.planes_entry.n), root.n) /
                                   select(by_cap, span.planes_entry.m, root.m)};
}
template <class W>
BoundaryHit<RunningError<W>> find_boundary_hit(const JoinedSpan<RunningError<W>>& span,
                                               const mask_t<typename RunningError<W>::P>& far) {
    using P = typename RunningError<W>::P;
    const QuadraticSpan<RunningError<W>> quadratic{
        select(far, span.leave.h, span.enter.h), select(far, span.leave.c, span.enter.c),
        select(far, span.leave.a, span.enter.a), select(far, span.leave.q, span.enter.q), span.d2};
    return {P(0) <= P(0), root_of(quadratic, far, (quadratic.h > RunningError<W>(0)).yes())};
}

/// Answer of `truth::enclose` for the usual convention, for a ray that begins at `begin` and not on the surface. A
/// ray from outside hits where it enters, a ray from inside where it leaves, if this point lies in the range.
template <class E, class S, class Begin>
SpanHit<E> first_span_hit_from(const S& s, const Begin& begin, const mask_t<E>& entry_in_range,
                               const mask_t<E>& exit_in_range) {
    using P = typename E::P;
    const auto enters = s.compare_entry(begin), leaves = s.compare_exit(begin);
    const auto open = s.meets_open().yes() && leaves.at_most.no(), no_lane = P(0) < P(0);
    const auto hits_near = open && enters.at_most.no() && entry_in_range.yes();
    const auto hits_far = open && enters.less.yes() && exit_in_range.yes();
    const auto missed = s.meets_closed().no() || leaves.less.yes() || (enters.at_most.no() && entry_in_range.no()) ||
                        (enters.less.yes() && exit_in_range.no());
    if (is_unset(hits_near || hits_far)) return {no_lane, missed, no_lane, E(1)};
    const BoundaryHit<E> boundary = find_boundary_hit(s, hits_far);
    return {(hits_near || hits_far) && boundary.known, missed, no_lane, boundary.t};
}
template <class W, template <class> class Span>
requires ComparableSpan<Span<RunningError<W>>, RunningError<W>> SpanHit<RunningError<W>> first_span_hit(
    const Span<RunningError<W>>& s) {
    using E = RunningError<W>;
    const auto always = E(0) <= E(0);
    return first_span_hit_from<E>(s, ZeroParameter(), always, always);
}

/// Answer of `truth::enclose` for a ray with a range.
template <class W, template <class> class Span>
requires ComparableSpan<Span<RunningError<W>>, RunningError<W>> SpanHit<RunningError<W>> first_span_hit(
    const Span<RunningError<W>>& s, const SpanRange<RunningError<W>>& range) {
    return first_span_hit_from<RunningError<W>>(s, Fraction<RunningError<W>>{range.begin, RunningError<W>(1)},
                                                entry_in_time(s.compare_entry(range.end), range),
                                                is_before_range_end(s.compare_exit(range.end), range));
}

/// First t on a surface of degree four: the answer of `truth::enclose` for the usual convention. If every root is known
/// to be simple, the first root ahead is an entry or an exit.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const QuarticSpan<RunningError<W>>& span) {
    using P = typename RunningError<W>::P;
    const FirstRoot<RunningError<W>> root = first_root(span.f, span.b, span.bound);
    return {root.is_found, root.is_absent, P(0) < P(0), span.t_at(root.root)};
}

/// Answer of `truth::enclose` for a ray with a range.
template <class W>
SpanHit<RunningError<W>> first_span_hit(const QuarticSpan<RunningError<W>>& span,
                                        const SpanRange<RunningError<W>>& range) {
    using P = typename RunningError<W>::P;
    const FirstRoot<RunningError<W>> root = first_root(span.f, span.x_at(range.begin), span.bound);
    const RunningError<W> end = span.a * range.end.n + span.b * range.end.m;
    const auto is_in_time = (root.high * range.end.m < end).yes(), is_late = (root.low * range.end.m > end).yes();
    return {root.is_found && is_in_time, root.is_absent || (root.is_found && is_late), P(0) < P(0),
            span.t_at(root.root)};
}

}  // namespace lostbits::measure::stages
