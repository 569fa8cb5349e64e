// Rays and solids of any shape: decisions, and t* with its bound, from where the line is inside of the solid
// (geometry/span.hpp). The numbers carry the bounds, so that no lemma is needed.
#pragma once

#include <type_traits>
#include <utility>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/ray.hpp"
#include "geometry/span.hpp"
#include "measure/stages/problem.hpp"
#include "number/wide/running.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::stages {

using number::wide::Running;

/// The first t of a ray at which it meets a closed solid, where the open one agrees: `hit` and `missed` hold where that
/// is proved. Where `at_origin` holds too t* is 0, and `t` is not asked for.
template <class E>
struct Met {
    mask_t<typename E::P> hit, missed, at_origin;
    E t;
};

/// c/(−h + √q), or the far root where it is that: −c/(h + √q) where h is `past` 0, (−h + √q)/a where not. Where h is
/// not told from 0, either form of it will do.
template <class E>
E root_of(const QuadraticSpan<E>& s, const mask_t<typename E::P>& far, const mask_t<typename E::P>& past) {
    const auto by_far = far && past, by_a = far && !past;
    const E size = sqrt(s.q) + select(by_far, s.h, -s.h);
    return select(by_a, size, select(by_far, -s.c, s.c)) / select(by_a, s.a, size);
}

/// As `truth::enclose` has it for the usual convention.
template <class W>
Met<Running<W>> first_met(const QuadraticSpan<Running<W>>& s) {
    using E = Running<W>;
    using P = typename E::P;
    const E zero(0);
    const auto outside = s.c > zero;
    const auto inside = s.c < zero;
    const auto past = s.h > zero;
    const auto hit = (s.q > zero).yes() && (inside.yes() || (outside.yes() && (s.h < zero).yes()));
    const auto missed = outside.yes() && ((s.h >= zero).yes() || (s.q < zero).yes()), none = P(0) < P(0);
    if (!any_of(hit)) return {hit, missed, none, zero};
    return {hit, missed, none, root_of(s, inside.yes(), past.yes())};
}

/// The same of a ray with a range.
template <class W>
Met<Running<W>> first_met(const QuadraticSpan<Running<W>>& s, const RangeOfSpan<Running<W>>& range) {
    using E = Running<W>;
    using P = typename E::P;
    const E zero(0);
    const auto begin = quadratic_at(s, range.begin), end = quadratic_at(s, range.end);
    const auto outside = begin.value > zero, inside = begin.value < zero;
    const auto near_in = in_time(end.near_root(), range), far_in = in_time(end.far_root(), range);
    const auto far = inside.yes() && far_in.yes();
    const auto near = outside.yes() && (begin.slope < zero).yes() && near_in.yes();
    const auto hit = (s.q > zero).yes() && (near || far);
    const auto missed = (outside.yes() && ((begin.slope >= zero).yes() || (s.q < zero).yes() || near_in.no())) ||
                        (inside.yes() && far_in.no());
    const auto none = P(0) < P(0);
    if (!any_of(hit)) return {hit, missed, none, zero};
    return {hit, missed, none, root_of(s, far, (s.h > zero).yes())};
}

/// A number that is compared by its first word, which is known to be good to 2^-51 of itself: it is enough for nearly
/// all.
///
/// Of such numbers x = a b and y = c d, as they round, are good to 2.3·2^-51 of themselves and 2^-1074, and x − y to
/// 2^-53 more: a b < c d where x − y < −(2^-49 (|x| + |y|) + 2^-1000), and so on.
template <class W>
struct ByFirstWord {
    using P = typename Running<W>::P;
    using Mask = Tris<mask_t<P>>;

    Running<W> whole;

    ByFirstWord() = default;
    explicit ByFirstWord(int x) : whole(x) {}
    explicit ByFirstWord(const Running<W>& x) : whole(x) {}

    friend Order<Mask> order_of_products(const ByFirstWord& a, const ByFirstWord& b, const ByFirstWord& c,
                                         const ByFirstWord& d) {
        return told_apart(a.whole.first() * b.whole.first(), c.whole.first() * d.whole.first(), P(0x1p-1000));
    }
    friend Mask operator<(const ByFirstWord& a, const ByFirstWord& b) { return order_of(a, b).less; }
    friend Mask operator<=(const ByFirstWord& a, const ByFirstWord& b) { return order_of(a, b).at_most; }
    friend Mask operator>(const ByFirstWord& a, const ByFirstWord& b) { return order_of(b, a).less; }
    friend Mask operator>=(const ByFirstWord& a, const ByFirstWord& b) { return order_of(b, a).at_most; }
    friend ByFirstWord select(const Mask& mask, const ByFirstWord& a, const ByFirstWord& b) {
        return ByFirstWord(select(mask, a.whole, b.whole));
    }

private:
    static Order<Mask> order_of(const ByFirstWord& a, const ByFirstWord& b) {
        return told_apart(a.whole.first(), b.whole.first(), P(0));
    }
    static Order<Mask> told_apart(const P& x, const P& y, const P& least) {
        using lostbits::abs;
        const P d = x - y, e = P(0x1p-49) * (abs(x) + abs(y)) + least, low = d - e, high = d + e;
        return {{high < P(0), low >= P(0)}, {high <= P(0), low > P(0)}};
    }
};

/// Slabs in numbers that are compared by their first word, and whether those are good enough: to 2^-51 of themselves.
template <class W>
struct QuickSlabs {
    SlabSpan<ByFirstWord<W>> span;
    mask_t<typename Running<W>::P> told;
};
template <class W>
QuickSlabs<W> quick(const SlabSpan<Running<W>>& s) {
    using E = Running<W>;
    using P = typename E::P;
    using lostbits::abs;
    using Quick = ByFirstWord<W>;
    QuickSlabs<W> q{{.entry = {}, .exit = {}, .crossed = s.crossed, .closed = s.closed, .open = s.open, .d2 = {}},
                    P(0) <= P(0)};
    const auto quickly = [&q](const E& x) {
        q.told = q.told && x.radius() <= P(0x1p-52) * abs(x.first());  // and the second word is at most as much
        return Quick(x);
    };
    for_each_axis([&](auto i) {
        const Quick m = quickly(s.entry[i].m);
        q.span.entry[i] = {quickly(s.entry[i].n), m};
        q.span.exit[i] = {quickly(s.exit[i].n), m};
    });
    return q;
}

/// As `truth::enclose` has it for the usual convention. Nothing is said where a first word is not good to 2^-51 of
/// itself.
template <class W>
Met<Running<W>> first_met(const SlabSpan<Running<W>>& s) {
    using E = Running<W>;
    using Quick = ByFirstWord<W>;
    const auto [q, told] = quick(s);
    const InSlabs<Quick> in = in_slabs(q);
    const Fraction<Quick> first = first_entry(q);
    const auto at_origin = (first.n <= Quick(0)).yes(), hit = told && in.open.yes(), missed = told && in.closed.no();
    const E one(1);
    if (!any_of(hit)) return {hit, missed, at_origin, one};
    return {hit, missed, at_origin, select(at_origin, one, first.n.whole) / select(at_origin, one, first.m.whole)};
}

/// The same of a ray with a range.
template <class W>
Met<Running<W>> first_met(const SlabSpan<Running<W>>& s, const RangeOfSpan<Running<W>>& range) {
    using E = Running<W>;
    using Quick = ByFirstWord<W>;
    const auto [q, told] = quick(s);
    const RangeOfSpan<Quick> within{Quick(range.begin), {Quick(range.end.n), Quick(range.end.m)}, range.open};
    const InSlabs<Quick> in = in_slabs(q, within);
    const Fraction<Quick> first = first_entry(q, within);
    const auto at_begin = entries_to_begin(q, within).at_most.yes();
    const auto at_origin = at_begin && (range.begin <= E(0)).yes();
    const auto hit = told && in.open.yes(), missed = told && in.closed.no();
    const E one(1);
    if (!any_of(hit)) return {hit, missed, at_origin, one};
    const E t = select(at_begin, one, first.n.whole) / select(at_begin, one, first.m.whole);
    return {hit, missed, at_origin, select(at_begin, range.begin, t)};
}

/// As `truth::enclose` has it for the usual convention, where neither the rim nor the origin is met.
template <class W>
Met<Running<W>> first_met(const FlatSpan<Running<W>>& s) {
    using P = typename Running<W>::P;
    const Running<W> zero(0), one(1);
    const auto hit = s.open.yes() && (s.at.n > zero).yes(), none = P(0) < P(0);
    const auto missed = s.closed.no() || (s.at.n < zero).yes();
    if (!any_of(hit)) return {hit, missed, none, zero};
    return {hit, missed, none, s.at.n / select(hit, s.at.m, one)};
}

/// The same of a ray with a range, where it does not begin on the surface.
template <class W>
Met<Running<W>> first_met(const FlatSpan<Running<W>>& s, const RangeOfSpan<Running<W>>& range) {
    using P = typename Running<W>::P;
    const Running<W> zero(0), one(1);
    const auto to_begin = order_of(s.at, Fraction<Running<W>>{range.begin, one});
    const auto ends = in_time(order_of(s.at, range.end), range);
    const auto hit = s.open.yes() && to_begin.at_most.no() && ends.yes(), none = P(0) < P(0);
    const auto missed = s.closed.no() || to_begin.less.yes() || ends.no();
    if (!any_of(hit)) return {hit, missed, none, zero};
    return {hit, missed, none, s.at.n / select(hit, s.at.m, one)};
}

/// A span that says of itself whether it is met.
template <class S>
concept TellsWhetherMet = requires(const S& s) {
    s.is_met(), s.is_open();
};

/// Where the line enters, or leaves where it is `far`, and whether that is known, in the lanes of a hit.
template <class E>
struct MetAt {
    mask_t<typename E::P> known;
    E t;
};
template <class W>
MetAt<Running<W>> met_at(const CappedSpan<Running<W>>& s, const mask_t<typename Running<W>::P>& far) {
    using E = Running<W>;
    const auto near_cap = s.enters_by_cap(), far_cap = s.leaves_by_cap();
    const auto by_cap = (!far && near_cap.yes()) || (far && far_cap.yes());
    const auto by_side = (!far && near_cap.no()) || (far && far_cap.no());
    const E one(1), cap = select(by_cap, select(far, s.exit.n, s.entry.n), one) / select(by_cap, s.entry.m, one);
    return {by_cap || by_side, select(by_cap, cap, root_of(s.side, far, (s.side.h > E(0)).yes()))};
}
template <class W>
MetAt<Running<W>> met_at(const JoinedSpan<Running<W>>& s, const mask_t<typename Running<W>::P>& far) {
    using P = typename Running<W>::P;
    const QuadraticSpan<Running<W>> at{select(far, s.leave.h, s.enter.h), select(far, s.leave.c, s.enter.c),
                                       select(far, s.leave.a, s.enter.a), select(far, s.leave.q, s.enter.q), s.d2};
    return {P(0) <= P(0), root_of(at, far, (at.h > Running<W>(0)).yes())};
}

/// As `truth::enclose` has it for the usual convention, of a ray that begins at `begin` and does not begin on the
/// surface: from outside where it enters, from inside where it leaves, each in the range where there is one.
template <class S, class E>
Met<E> first_met_from(const S& s, const Fraction<E>& begin, const mask_t<E>& entry_in, const mask_t<E>& exit_in) {
    using P = typename E::P;
    const auto enters = s.enters_to(begin), leaves = s.leaves_to(begin);
    const auto open = s.is_open().yes() && leaves.at_most.no(), none = P(0) < P(0);
    const auto near = open && enters.at_most.no() && entry_in.yes();
    const auto far = open && enters.less.yes() && exit_in.yes();
    const auto missed = s.is_met().no() || leaves.less.yes() || (enters.at_most.no() && entry_in.no()) ||
                        (enters.less.yes() && exit_in.no());
    if (!any_of(near || far)) return {none, missed, none, E(1)};
    const MetAt<E> at = met_at(s, far);
    return {(near || far) && at.known, missed, none, at.t};
}
template <class W, template <class> class Span>
requires TellsWhetherMet<Span<Running<W>>> Met<Running<W>> first_met(const Span<Running<W>>& s) {
    using E = Running<W>;
    const auto always = E(0) <= E(0);
    return first_met_from<Span<E>, E>(s, {E(0), E(1)}, always, always);
}

/// The same of a ray with a range.
template <class W, template <class> class Span>
requires TellsWhetherMet<Span<Running<W>>> Met<Running<W>> first_met(const Span<Running<W>>& s,
                                                                     const RangeOfSpan<Running<W>>& range) {
    return first_met_from<Span<Running<W>>, Running<W>>(s, {range.begin, Running<W>(1)},
                                                        in_time(s.enters_to(range.end), range),
                                                        in_time(s.leaves_to(range.end), range));
}

/// Whether a length is known closely enough: to 2^-33 of itself in one word, as `narrow_tightness` has it, to 2^-72 in
/// two; and in one binade, in range of what follows.
template <class P>
mask_t<P> is_close(const Running<P>& x) {
    return x.radius() <= P(narrow_tightness) * x.words() && in_one_binade(x.words(), x.radius());
}
template <class P>
mask_t<P> is_close(const Running<TwoWords<P>>& x) {
    return x.radius() <= P(wide_tightness) * x.first() && in_range(x.first()) && in_one_binade(x.words(), x.radius());
}
template <class P>
Enclosure<P> enclosure_of(const Running<P>& x) {
    return {{x.words(), P(0)}, x.radius()};
}
template <class P>
Enclosure<P> enclosure_of(const Running<TwoWords<P>>& x) {
    return {x.words(), x.radius()};
}

/// Whether a solid is one, by the limits of its keys: but for points on one line, which no line is proved to cross;
/// origins and directions that are not finite are found by `settle`.
template <class S, class E>
mask_t<typename E::P> is_proper(const std::array<E, most_numbers>& solid) {
    using P = typename E::P;
    auto proper = P(0) <= P(0);
    std::size_t k = 0;
    for (const Key& key : S::keys) {
        for (const std::size_t end = k + key.count(); k < end; ++k) {
            if (key.limit == Key::Limit::positive) proper = proper && (solid[k] > E(0)).yes();
            if (key.limit == Key::Limit::at_least_before) proper = proper && (solid[k - key.count()] <= solid[k]).yes();
        }
    }
    return proper;
}

/// A range of these numbers, where it holds more than one t: else, by `proper`, nothing is said.
template <class E, class P = typename E::P>
RangeOfSpan<E> range_of(const P& tmin, const P& tmax, OpenEnds open, mask_t<P>& proper) {
    const auto endless = tmax >= P(HUGE_VAL);
    proper = proper && tmin >= P(0) && tmin < P(HUGE_VAL) && tmin < tmax;
    const auto exactly = [](const P& x) { return E(std::remove_cvref_t<decltype(std::declval<E>().words())>(x)); };
    return {exactly(tmin), {exactly(select(endless, P(1), tmax)), exactly(select(endless, P(0), P(1)))}, open};
}

/// S is the shape over `Running` words; `range` is tmin, tmax and which are open, or nothing.
template <Wanted wanted, class S, class E, class... Ends>
Finding<typename E::P> settle_shape(const Ray<E>& ray, const std::array<E, most_numbers>& solid, const Ends&... range) {
    using P = typename E::P;
    using lostbits::abs;
    const auto span = S::of([&solid](std::size_t k) { return solid[k]; }).span(ray);
    auto proper = is_proper<S>(solid) && (span.d2 > E(0)).yes() &&
                  sum_of_sizes(ray.origin.x.first(), ray.origin.y.first(), ray.origin.z.first()) < P(HUGE_VAL);
    const auto met = [&] {
        if constexpr (sizeof...(range) > 0) return first_met(span, range_of<E>(range..., proper));
        else return first_met(span);
    }();
    const auto missed = proper && met.missed;
    auto hit = proper && met.hit;
    const P zero(0);
    Finding<P> found{missed, hit, {{zero, zero}, zero}, {{zero, zero}, zero}};
    if (!any_of(hit)) return found;
    const auto take = [&](const E& length, Enclosure<P>& to) {
        hit = hit && (met.at_origin || is_close(length));
        to = enclosure_of(length);
        to.middle = select<P>(met.at_origin, {zero, zero}, to.middle);
        to.bound = select(met.at_origin, zero, to.bound);
    };
    if constexpr (wanted != Wanted::distance) take(met.t, found.t);
    if constexpr (wanted != Wanted::parameter) take(met.t * sqrt(span.d2), found.distance);
    found.settled = hit || missed;
    found.hit = hit;
    return found;
}

}  // namespace lostbits::measure::stages
