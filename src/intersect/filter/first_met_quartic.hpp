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

/// What a bound proves of the first root behind `begin` of a line that comes from before all of them, or from b:
///
///   - no root: b lies behind ±bound; or p > 0 and q² < 4 p r, at which p x² + q x + r > 0; or Sturm's chain has no
///   more
///     changes of sign at the begin than at infinity;
///   - x within `away`: f changes its sign between x − away and x + away, and the chain has as many changes at the
///     former as at the begin. Newton's step, which `away` is 5/4 of with its bound, leads at most that far where f is
///     nearly straight.
template <class U>
struct ProvedRoot {
    using P = typename U::P;
    using Lanes = mask_t<P>;

    QuarticChain<U> chain;
    U b, bound;
    Lanes ahead, none, some;  ///< whether the line comes from before all roots, whether there is none, or one
    P changes;                ///< at the begin

    ProvedRoot(const QuarticChain<U>& of, const U& begin, const U& reach) : chain(of), b(begin), bound(reach) {
        const U zero(0);
        ahead = (b < -bound).yes();
        const auto last = changes_in(chain.at_infinity());
        const Changes<U> at_minus =
            changes_in(typename QuarticChain<U>::Values{chain.n, -chain.n, -chain.p, -chain.u, chain.last});
        const Changes<U> at_b = changes_in(chain.at(b));
        const Lanes known = last.known && ((ahead && at_minus.known) || (!ahead && at_b.known));
        changes = select(ahead, at_minus.count, at_b.count);
        const Lanes above = (chain.p > zero && U(4) * chain.p * chain.r > square(chain.q)).yes();
        none = (b > bound).yes() || above || (known && changes <= last.count);
        some = known && changes > last.count;
    }

    /// Near a root by its word; the mask says where it is proved.
    struct Found {
        Lanes proved;
        P radius;
    };
    [[nodiscard]] Found around(const P& x) const {
        using lostbits::abs;
        using number::wide::roundoff_of, number::wide::outward_of;
        const U off = chain.value(U(x)) / chain.slope(U(x)), zero(0);
        const P away = P(5) / P(4) * (abs(off.word()) + off.radius()) + P(4) * roundoff_of<P>() * abs(x);
        const U low(x - away), high(x + away);
        const auto at_low = chain.at(low);
        const Changes<U> before = changes_in(at_low);
        const U behind = chain.value(high);
        const Lanes turns =
            ((at_low[0] < zero).yes() && (behind > zero).yes()) || ((at_low[0] > zero).yes() && (behind < zero).yes());
        return {some && before.known && before.count >= changes && turns && (ahead || (low > b).yes()),
                away * outward_of<P>()};
    }
};

template <class T>
FirstMet<number::wide::Proving<T>> first_met(const QuarticSpan<number::wide::Proving<T>>& s) {
    using E = number::wide::Proving<T>;
    using U = number::wide::Proving<typename E::P>;
    const auto untold = [](const E& x) { return U(number::wide::untold(x.word()), x.radius()); };
    const ProvedRoot<U> root(QuarticChain<U>(untold(s.f.c[4]), untold(s.f.c[2]), untold(s.f.c[1]), untold(s.f.c[0])),
                             untold(s.b), untold(s.bound));
    const E missed(-1);
    if (!any_of(root.some)) return {typename E::Mask(root.some, root.none), missed};
    const QuarticChain<T> words(s.f.c[4].word(), s.f.c[2].word(), s.f.c[1].word(), s.f.c[0].word());
    const T x = near_first_root<T>(words, s.b.word(), s.bound.word(), 5);
    const auto found = root.around(number::wide::untold(x));
    const typename E::Mask hit(found.proved, root.none);
    return {hit, select(hit, s.time(E(x, found.radius)), missed)};
}

}  // namespace lostbits::intersect::filter
