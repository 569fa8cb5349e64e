// The first root of a quartic beyond a point, for many rays at once, with a bound on its error.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits {

/// Number of Newton steps after the bisection.
inline constexpr int newton_steps = 4;

/// First root of f beyond `begin`. If `is_found`, `root` lies between `low` and `high`, where f has different signs,
/// and no root lies between `begin` and `low`. If `is_absent`, f is proved to have no root beyond `begin`.
template <class E>
struct FirstRoot {
    mask_t<typename E::P> is_found, is_absent;
    E low, high, root;
};
template <class W>
FirstRoot<number::wide::RunningError<W>> first_root(const Polynomial<number::wide::RunningError<W>>& f,
                                                    const number::wide::RunningError<W>& begin,
                                                    const number::wide::RunningError<W>& bound) {
    using E = number::wide::RunningError<W>;
    using P = typename E::P;
    using lostbits::abs;
    using lostbits::max;
    using number::wide::is_unset;
    const QuarticChain<E> chain(f);
    const auto begin_changes = prove_sign_changes(chain.at(begin));
    const auto roots_ahead = prove_roots_between(begin_changes, prove_sign_changes(chain.at_infinity()), chain.last);

    const E zero(0);
    if (is_unset(roots_ahead.is_present)) return {roots_ahead.is_present, roots_ahead.is_absent, zero, zero, zero};

    // Approximates the root in one word, and refines it by Newton steps in all words.
    const QuarticChain<P> leading_words_chain(f.c[4].first(), f.c[2].first(), f.c[1].first(), f.c[0].first());
    E x(W(approximate_first_root(leading_words_chain, begin.first(), bound.first(), newton_steps)));
    for (int i = 0; i < 2; ++i) x = E((x - chain.value(x) / E(chain.slope(x).words())).words());

    // Encloses the root within twice the distance that one more step would move it.
    const E newton_step = chain.value(x) / E(chain.slope(x).words());
    const E distance(W(P(2) * (abs(newton_step.first()) + newton_step.radius()) + P(0x1p-110) * bound.first()));
    const E low((x - distance).words()), high((x + distance).words());
    const E to_low = x - low, to_high = high - x;
    const P radius = max(abs(to_low.first()) + to_low.radius(), abs(to_high.first()) + to_high.radius());

    const auto is_found =
        roots_ahead.is_present && (low > begin).yes() && is_first_between(chain, begin_changes, low, high);
    return {is_found, roots_ahead.is_absent, low, high, E(x.words(), radius * P(1 + 0x1p-40))};
}

}  // namespace lostbits
