// The first hit of a ray with a surface of degree four: over numbers that prove their decisions, over enclosures, and
// over numbers without rounding.
#pragma once

#include "geometry/first_root.hpp"
#include "geometry/quartic_span.hpp"
#include "intersect/filter/first_span_hit.hpp"
#include "number/wide/proving_number.hpp"

namespace lostbits::intersect::filter {

/// The value where the ray begins, of f divided by its common factor with its slope, is a polynomial of degree 62 in
/// the inputs: 62 (1024 + 1074) + 70 < 131072. Balls distinguish some double roots that two words with a running bound
/// do not, and take seven times as long.
template <class E>
struct FallbackLimits<QuarticSpan<E>> {
    static constexpr long enough_bits = 131072;
    static constexpr bool tries_running_words = true;
};

/// The first root, if the signs along Sturm's chain show one, and 0 if the ray begins at a root.
template <class E>
FirstSpanHit<E> first_span_hit(const QuarticSpan<E>& span) {
    const QuarticChain<E> chain(span.f);
    const auto values = chain.at(span.b);
    const auto at_begin = values[0] <= E(0) && values[0] >= E(0);
    const E x = approximate_first_root<E>(chain, span.b, span.bound, 6);
    return {at_begin || count_sign_changes(values) > count_sign_changes(chain.at_infinity()),
            select(at_begin, E(0), span.t_at(x))};
}

/// Numbers that enclose roots (geometry/real_roots.hpp).
template <class E>
concept EnclosesRoots = is_exact<E> && requires(const E& x) {
    largest_magnitude(x);
};

/// The first root that does not lie before the beginning of the ray; the line touches or crosses the surface there.
template <EnclosesRoots E>
FirstSpanHit<E> first_span_hit(const QuarticSpan<E>& span) {
    const E zero(0);
    const FirstSpanHit<E> unknown{Tri::unknown, zero / zero};
    if (known_sign(span.f.leading()) != 1) return unknown;  // the axis has no length
    const auto roots = enclose_roots(span.f, span.bound);
    if (!roots) return unknown;
    for (int i = 0; i < roots->count; ++i) {
        const auto order = roots->order(i, span.b);
        if (!order) return unknown;
        if (*order == 0) return {Tri::yes, zero};
        if (*order > 0) return {Tri::yes, span.t_at((*roots)[i].root)};
    }
    return {Tri::no, E(-1)};
}

/// True if p > 0 and q² < 4 p r. Then p x² + q x + r is positive and f has no root. This test is for lines far from the
/// surface: two pairs of complex roots are then so close to each other that the signs along the chain are not known.
template <class U>
mask_t<typename U::P> is_above(const QuarticChain<U>& f) {
    return (f.p > U(0) && U(4) * f.p * f.r > square(f.q)).yes();
}

/// Finds the first root by the signs along Sturm's chain. A Newton step near the root, with its bound, shows how far
/// away the root can be. At that distance and one sixteenth more, on either side, f has different signs. For a miss
/// this search is skipped, except while a tape is written, which has the same operations for every ray.
template <class T>
FirstSpanHit<number::wide::ProvingNumber<T>> first_span_hit(const QuarticSpan<number::wide::ProvingNumber<T>>& span) {
    using E = number::wide::ProvingNumber<T>;
    using P = typename E::P;
    using U = number::wide::ProvingNumber<P>;
    using lostbits::abs;
    const auto value_of = [](const E& x) { return U(number::wide::plain_value(x.word()), x.radius()); };
    const QuarticChain<U> f(value_of(span.f.c[4]), value_of(span.f.c[2]), value_of(span.f.c[1]), value_of(span.f.c[0]));

    // Counts the roots ahead. A line far from the surface has none.
    const U b = value_of(span.b);
    const auto changes_at_begin = prove_sign_changes(f.at(b));
    const auto roots_ahead = prove_roots_between(changes_at_begin, prove_sign_changes(f.at_infinity()), f.last);
    const auto is_miss = roots_ahead.is_absent || is_above(f);
    const E miss_t(-1);
    if constexpr (!traces_operations<T>)
        if (!any_of(!is_miss)) return {typename E::Mask(!is_miss, is_miss), miss_t};

    // Approximates the first root, and bounds its distance by a Newton step.
    const QuarticChain<T> words(span.f.c[4].word(), span.f.c[2].word(), span.f.c[1].word(), span.f.c[0].word());
    const T x = approximate_first_root<T>(words, span.b.word(), span.bound.word(), 5);
    const P x_value = number::wide::plain_value(x);
    const U step = f.value(U(x_value)) / f.slope(U(x_value));
    const P distance =
        P(17) / P(16) * (abs(step.word()) + step.radius()) + P(4) * number::wide::roundoff<P>() * abs(x_value);

    // Proves that the first root lies within that distance, ahead of the beginning.
    const U low(x_value - distance), high(x_value + distance);
    const auto is_found = !is_miss && (low > b).yes() && is_first_between(f, changes_at_begin, low, high);
    const typename E::Mask hit(is_found, is_miss);
    return {hit, select(hit, span.t_at(E(x, distance * number::wide::outward_factor<P>())), miss_t)};
}

/// Computes in two words, as the packs of the truth do.
template <class W>
FirstSpanHit<number::wide::RunningError<W>> first_span_hit(const QuarticSpan<number::wide::RunningError<W>>& span) {
    const auto root = first_root(span.f, span.b, span.bound);
    return {{root.is_found, root.is_absent}, span.t_at(root.root)};
}

}  // namespace lostbits::intersect::filter
