// Where a ray meets a closed solid first, from where its line is inside of it (geometry/span.hpp): one formula, over
// numbers that prove what they decide, over enclosures and over numbers without rounding.
#pragma once

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/span.hpp"
#include "geometry/wall_span.hpp"

namespace lostbits::intersect::filter {

/// Whether there is a t ≥ 0 at which the ray meets the solid: touching counts, and so does t = 0. The first such, from
/// inside the exit.
template <class E>
struct FirstMet {
    mask_t<E> hit;
    E t;
};

/// By which arithmetics a ray's first meeting of a span is settled where that of the form proves nothing.
template <class Span>
struct Deciding {
    /// What decides is of degree 12 in the inputs at most, so that so many bits hold it exactly.
    static constexpr long enough_bits = 32768;
    /// Whether two words with a running bound are tried before balls.
    static constexpr bool tries_running_words = false;
};

/// Whether x is positive, of an x close to 0 either answer: always an answer.
template <class E>
mask_t<E> leans_up(const E& x) {
    if constexpr (requires { x.leans_up(); }) return x.leans_up();
    else if constexpr (std::same_as<mask_t<E>, Tri>) return Tri((x > E(0)).is_yes());
    else return x > E(0);
}

/// Whether E proves that a number is 0.
template <class E>
inline constexpr bool knows_zero = !requires(const E& x) {
    x.leans_up();
};

/// The near root, c/(−h + √q), or −(h + √q)/a where h is positive; or the far one, where it is that, (−h + √q)/a, or
/// −c/(h + √q): none of them subtracts. Where h = q = 0 the roots are 0 as the surface is met there alone (c = 0).
template <class E>
Fraction<E> root_of(const QuadraticSpan<E>& s, const mask_t<E>& far) {
    const auto past = leans_up(s.h), by_a = (far && !past) || (!far && past);
    const E size = sqrt(s.q) + select(past, s.h, -s.h), n = select(by_a, size, s.c);
    const Fraction<E> root{select(past, -n, n), select(by_a, s.a, size)};
    if constexpr (knows_zero<E>) return select(size <= E(0), Fraction<E>{E(0), E(1)}, root);
    else return root;
}

/// Where the line enters, or leaves where it is `far`.
template <class E>
Fraction<E> end_of(const CappedSpan<E>& s, const mask_t<E>& far) {
    const auto by_cap = (far && s.leaves_by_cap()) || (!far && s.enters_by_cap());
    return select(by_cap, select(far, s.exit, s.entry), root_of(s.side, far));
}
template <class E>
Fraction<E> end_of(const JoinedSpan<E>& s, const mask_t<E>& far) {
    return root_of(select(far, s.leave, s.enter), far);
}

template <class E>
FirstMet<E> met_at(const mask_t<E>& hit, const Fraction<E>& at) {
    return {hit, at.n / at.m};
}

/// From outside (c > 0) the near root, where the line comes closer and meets the surface; of a ray that begins on it
/// the root that is 0, the far one of those that leave.
template <class E>
FirstMet<E> first_met(const QuadraticSpan<E>& s) {
    const E zero(0);
    const auto outside = s.c > zero, far = s.c < zero || (!outside && s.h > zero);
    return met_at(!outside || (s.h < zero && s.q >= zero), root_of(s, far));
}

/// Where it leaves no earlier than the ray begins: the entry, or the exit where the ray begins behind that. A line that
/// meets the surface alone, along a cap or a side, has no inside: a ray that begins behind its entry begins on it.
template <class E, template <class> class Span>
requires ToldSpan<Span<E>, E> FirstMet<E> first_met(const Span<E>& s) {
    const auto far = s.enters_to(Start{}).less;
    FirstMet<E> met = met_at(s.is_met() && !s.leaves_to(Start{}).less, end_of(s, far));
    if constexpr (knows_zero<E>) met.t = select(far && !s.is_open(), E(0), met.t);
    return met;
}

template <class E>
FirstMet<E> first_met(const FlatSpan<E>& s) {
    return met_at(s.closed && s.at.n >= E(0), s.at);
}

template <class E>
FirstMet<E> first_met(const WallSpan<E>& s) {
    const auto ahead = [&s](int i) { return s.crossing(i).closed && !s.order_to(i, Start{}).less; };
    const auto near = ahead(0);
    return met_at(near || ahead(1), root_of(s.solid.side, !near));
}

}  // namespace lostbits::intersect::filter
