// Where a ray first meets a surface of degree four: over numbers that prove what they decide, over enclosures, and over
// numbers without rounding.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "geometry/quartic_span.hpp"
#include "intersect/filter/first_met.hpp"
#include "number/wide/proving.hpp"

namespace lostbits::intersect::filter {

/// The first of the roots as far as signs along Sturm's chain tell, and 0 where the ray begins at one.
template <class E>
FirstMet<E> first_met(const QuarticSpan<E>& s) {
    const QuarticChain<E> chain(s.f);
    const auto values = chain.at(s.b);
    const auto at_begin = values[0] <= E(0) && values[0] >= E(0);
    const E x = near_first_root<E>(chain, s.b, s.bound, 6);
    return {at_begin || sign_changes(values) > sign_changes(chain.at_infinity()), select(at_begin, E(0), s.time(x))};
}

/// Numbers that enclose roots (geometry/real_roots.hpp).
template <class E>
concept EnclosesRoots = stands_for_exact<E> && requires(const E& x) {
    largest(x);
};

/// The first root that does not lie before the ray begins, touched or crossed.
template <EnclosesRoots E>
FirstMet<E> first_met(const QuarticSpan<E>& s) {
    const E zero(0);
    const FirstMet<E> unknown{Tri::unknown, zero / zero};
    if (known_sign(s.f.leading()) != 1) return unknown;  // the axis has no length
    const auto roots = enclosed_roots(s.f, s.bound);
    if (!roots) return unknown;
    for (int i = 0; i < roots->count; ++i) {
        const auto order = roots->order(i, s.b);
        if (!order) return unknown;
        if (*order == 0) return {Tri::yes, zero};
        if (*order > 0) return {Tri::yes, s.time((*roots)[i].root)};
    }
    return {Tri::no, E(-1)};
}

/// What a bound proves of the roots at or behind b, where a line begins: that there is none, or some. None are where b
/// is more than `bound`; where p > 0 and q² < 4 p r, at which p x² + q x + r > 0; and where the signs along Sturm's
/// chain change no more often than at infinity.
template <class U>
struct RootsAhead {
    mask_t<typename U::P> none, some;
    mask_t<typename U::P> all;  ///< b comes before every root
    typename U::P changes;      ///< at b
};
template <class U>
RootsAhead<U> roots_ahead(const QuarticChain<U>& f, const U& b, const U& bound) {
    const auto all = (b < -bound).yes();
    const auto last = changes_in(f.at_infinity()), before = changes_in<U>({f.n, -f.n, -f.p, -f.u, f.last}),
               here = changes_in(f.at(b));
    const auto changes = select(all, before.count, here.count);
    const auto known = last.known && ((all && before.known) || (!all && here.known));
    const auto above = (f.p > U(0) && U(4) * f.p * f.r > square(f.q)).yes();
    const auto none = (b > bound).yes() || above || (known && changes <= last.count);
    return {none, known && changes > last.count, all, changes};
}

/// Whether the first of them is proved to be no farther than `away` from x: f changes its sign between x − away and x +
/// away, and the chain as often at the former as at b. Of Newton's step with its bound that is 5/4.
template <class U>
struct RootNear {
    mask_t<typename U::P> proved;
    typename U::P away;
};
template <class U, class P = typename U::P>
RootNear<U> root_near(const QuarticChain<U>& f, const P& x, const RootsAhead<U>& ahead, const U& b) {
    using lostbits::abs;
    const U step = f.value(U(x)) / f.slope(U(x)), zero(0);
    const P away = P(5) / P(4) * (abs(step.word()) + step.radius()) + P(4) * number::wide::roundoff_of<P>() * abs(x);
    const U low(x - away), high(x + away), above = f.value(high);
    const auto chain = f.at(low);
    const auto before = changes_in(chain);
    const U& below = chain[0];
    const auto turns = ((below < zero).yes() && (above > zero).yes()) || ((below > zero).yes() && (above < zero).yes());
    const auto first = before.known && before.count >= ahead.changes && (ahead.all || (low > b).yes());
    return {ahead.some && first && turns, away * number::wide::outward_of<P>()};
}

template <class T>
FirstMet<number::wide::Proving<T>> first_met(const QuarticSpan<number::wide::Proving<T>>& s) {
    using E = number::wide::Proving<T>;
    using U = number::wide::Proving<typename E::P>;
    const auto untold = [](const E& x) { return U(number::wide::untold(x.word()), x.radius()); };
    const QuarticChain<U> f(untold(s.f.c[4]), untold(s.f.c[2]), untold(s.f.c[1]), untold(s.f.c[0]));
    const U b = untold(s.b);
    const RootsAhead<U> ahead = roots_ahead(f, b, untold(s.bound));
    const E missed(-1);
    if (!any_of(ahead.some)) return {typename E::Mask(ahead.some, ahead.none), missed};
    const QuarticChain<T> words(s.f.c[4].word(), s.f.c[2].word(), s.f.c[1].word(), s.f.c[0].word());
    const T x = near_first_root<T>(words, s.b.word(), s.bound.word(), 5);
    const RootNear<U> root = root_near<U>(f, number::wide::untold(x), ahead, b);
    const typename E::Mask hit(root.proved, ahead.none);
    return {hit, select(hit, s.time(E(x, root.away)), missed)};
}

}  // namespace lostbits::intersect::filter
