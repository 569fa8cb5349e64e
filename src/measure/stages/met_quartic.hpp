// Where a ray meets a surface of degree four first, of many rays at once. Included by met_spans.hpp.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "geometry/quartic_span.hpp"
#include "measure/stages/met_spans.hpp"

namespace lostbits::measure::stages {

/// The first root of f behind `begin`: between `low` and `high`, where f changes its sign, and none comes before `low`.
template <class E>
struct FirstRoot {
    mask_t<typename E::P> found, none;
    E low, high, x;
};
template <class W>
FirstRoot<Running<W>> first_root(const Polynomial<Running<W>>& f, const Running<W>& begin, const Running<W>& bound) {
    using E = Running<W>;
    using P = typename E::P;
    using lostbits::abs;
    using lostbits::max;
    const QuarticChain<E> chain(f);
    const auto from = changes_in(chain.at(begin)), last = changes_in(chain.at_infinity());
    const auto none = from.known && last.known && from.count <= last.count;
    const auto some = from.known && from.count > last.count;
    const E zero(0);
    if (!any_of(some)) return {some, none, zero, zero, zero};
    const QuarticChain<P> words(f.c[4].first(), f.c[2].first(), f.c[1].first(), f.c[0].first());
    E x(W(near_first_root(words, begin.first(), bound.first(), 4)));
    for (int i = 0; i < 2; ++i) x = E((x - chain.value(x) / E(chain.slope(x).words())).words());
    const E off = chain.value(x) / E(chain.slope(x).words());
    const E away(W(P(2) * (abs(off.first()) + off.radius()) + P(0x1p-110) * bound.first()));
    const E low((x - away).words()), high((x + away).words());
    const auto at_low = chain.at(low);
    const auto before = changes_in(at_low);
    const E behind = chain.value(high);
    const auto turns =
        ((at_low[0] < zero).yes() && (behind > zero).yes()) || ((at_low[0] > zero).yes() && (behind < zero).yes());
    const auto found = some && before.known && before.count >= from.count && turns && (low > begin).yes();
    const E to_low = x - low, to_high = high - x;
    const P radius = max(abs(to_low.first()) + to_low.radius(), abs(to_high.first()) + to_high.radius());
    return {found, none, low, high, E(x.words(), radius * P(1 + 0x1p-40))};
}

/// As `truth::enclose` has it for the usual convention: the first root ahead is an entry or an exit, where every root
/// is known to be simple.
template <class W>
Met<Running<W>> first_met(const QuarticSpan<Running<W>>& s) {
    using P = typename Running<W>::P;
    const FirstRoot<Running<W>> root = first_root(s.f, s.b, s.bound);
    return {root.found, root.none, P(0) < P(0), s.time(root.x)};
}

/// The same of a ray with a range.
template <class W>
Met<Running<W>> first_met(const QuarticSpan<Running<W>>& s, const RangeOfSpan<Running<W>>& range) {
    using P = typename Running<W>::P;
    const FirstRoot<Running<W>> root = first_root(s.f, s.place(range.begin), s.bound);
    const Running<W> end = s.a * range.end.n + s.b * range.end.m;
    const auto in_time = (root.high * range.end.m < end).yes(), late = (root.low * range.end.m > end).yes();
    return {root.found && in_time, root.none || (root.found && late), P(0) < P(0), s.time(root.x)};
}

}  // namespace lostbits::measure::stages
