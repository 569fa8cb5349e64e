// The first hit of a ray with a closed primitive, from the span of its line (geometry/span.hpp). One formula serves
// numbers that prove their decisions, enclosures, and numbers without rounding.
#pragma once

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/span.hpp"
#include "geometry/wall_span.hpp"

namespace lostbits::intersect::filter {

/// The decision whether some t ≥ 0 lies in the closed primitive (touching counts, and so does t = 0), and the first
/// such t. For a ray from inside, t is that of the exit.
template <class E>
struct FirstSpanHit {
    mask_t<E> hit;
    E t;
};

/// Limits of the wider arithmetics that compute the first hit of a span again if the form's own arithmetic does not
/// prove the decision.
template <class Span>
struct FallbackLimits {
    /// The polynomials that decide have degree at most 12 in the inputs. This many bits hold them exactly.
    static constexpr long enough_bits = 32768;
    /// True if two words with a running bound (an error bound that each operation updates) are tried before balls.
    static constexpr bool tries_running_words = false;
};

/// True if x is positive. For an x close to 0 the answer may be wrong, but is never undecided.
template <class E>
mask_t<E> is_roughly_positive(const E& x) {
    if constexpr (requires { x.is_roughly_positive(); }) return x.is_roughly_positive();
    else if constexpr (std::same_as<mask_t<E>, Tri>) return Tri((x > E(0)).is_yes());
    else return x > E(0);
}

/// True if numbers of E have an exact sign, so that a comparison proves x = 0.
template <class E>
inline constexpr bool has_exact_sign = !requires(const E& x) {
    x.is_roughly_positive();
};

/// The near root is c/(−h + √q), or −(h + √q)/a if h is positive. The far root is (−h + √q)/a, or −c/(h + √q). None of
/// these expressions subtracts. If h = q = 0, the roots are 0, because the line meets the surface only there (c = 0).
template <class E>
Fraction<E> root_of(const QuadraticSpan<E>& span, const mask_t<E>& takes_far) {
    const auto is_h_positive = is_roughly_positive(span.h),
               divides_by_a = (takes_far && !is_h_positive) || (!takes_far && is_h_positive);
    const E magnitude = sqrt(span.q) + select(is_h_positive, span.h, -span.h),
            n = select(divides_by_a, magnitude, span.c);
    const Fraction<E> root{select(is_h_positive, -n, n), select(divides_by_a, span.a, magnitude)};
    if constexpr (has_exact_sign<E>) return select(magnitude <= E(0), Fraction<E>{E(0), E(1)}, root);
    else return root;
}

/// The t at which the line enters the primitive, or leaves it if `takes_far`.
template <class E>
Fraction<E> end_of(const CappedSpan<E>& span, const mask_t<E>& takes_far) {
    const auto by_cap = (takes_far && span.leaves_by_cap()) || (!takes_far && span.enters_by_cap());
    return select(by_cap, select(takes_far, span.planes_exit, span.planes_entry), root_of(span.side, takes_far));
}
template <class E>
Fraction<E> end_of(const JoinedSpan<E>& span, const mask_t<E>& takes_far) {
    return root_of(select(takes_far, span.leave, span.enter), takes_far);
}

template <class E>
FirstSpanHit<E> hit_at(const mask_t<E>& hit, const Fraction<E>& root) {
    return {hit, root.n / root.m};
}

/// First hit of a quadric. A ray from outside (c > 0) hits at the near root, if it approaches the surface and its line
/// meets it. A ray from inside hits at the far root. A ray that begins on the surface hits at the root that is 0: the
/// far root if the ray leaves the primitive, else the near root.
template <class E>
FirstSpanHit<E> first_span_hit(const QuadraticSpan<E>& span) {
    const E zero(0);
    const auto is_outside = span.c > zero, takes_far = span.c < zero || (!is_outside && span.h > zero);
    return hit_at(!is_outside || (span.h < zero && span.q >= zero), root_of(span, takes_far));
}

/// First hit of a closed primitive. The ray hits if its line meets the primitive and does not leave it before the ray
/// begins. The hit is the entry, or the exit if the ray begins behind the entry. A line along a cap or a side meets
/// only the surface. A ray on such a line that begins behind the entry begins on the surface, so its t is 0.
template <class E, template <class> class Span>
requires ComparableSpan<Span<E>, E> FirstSpanHit<E> first_span_hit(const Span<E>& s) {
    const auto takes_far = s.compare_entry(ZeroParameter{}).less;
    FirstSpanHit<E> first_hit = hit_at(s.meets_closed() && !s.compare_exit(ZeroParameter{}).less, end_of(s, takes_far));
    if constexpr (has_exact_sign<E>) first_hit.t = select(takes_far && !s.meets_open(), E(0), first_hit.t);
    return first_hit;
}

template <class E>
FirstSpanHit<E> first_span_hit(const FlatSpan<E>& span) {
    return hit_at(span.closed && span.at.n >= E(0), span.at);
}

template <class E>
FirstSpanHit<E> first_span_hit(const WallSpan<E>& span) {
    const auto is_ahead = [&span](int i) {
        return span.crossing(i).closed && !span.compare_crossing(i, ZeroParameter{}).less;
    };
    const auto is_first_ahead = is_ahead(0);
    return hit_at(is_first_ahead || is_ahead(1), root_of(span.primitive.side, !is_first_ahead));
}

}  // namespace lostbits::intersect::filter
