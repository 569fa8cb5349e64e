#include "intersect/filter/beyond.hpp"

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "intersect/filter/first_met.hpp"
#include "intersect/filter/first_met_quartic.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "number/wide/proving.hpp"
#include "number/wide/running.hpp"

namespace lostbits::intersect::filter {
namespace {

using number::wide::Proving, number::wide::Running, number::wide::TwoWords;

/// The answer that one arithmetic proves for a ray; nothing if it proves none.
using Told = std::optional<Beyond>;

constexpr Beyond missed(Way way) { return {false, -1, way}; }
/// Adding 0 turns -0 into +0.
constexpr Beyond hit_at(double t, Way way) { return {true, t + 0.0, way}; }

/// The proved answer: the decision, with t to within 8u of itself.
Told told(const FirstMet<Proving<double>>& met, double u) {
    if (met.hit.is_no()) return missed(Way::wider);
    const double t = met.t.word();
    if (met.hit.is_yes() && met.t.radius() <= 8 * u * t) return hit_at(t, Way::wider);
    return std::nullopt;
}
Told told(const FirstMet<Ball>& met, double u) {
    if (met.hit.is_no()) return missed(Way::two_words);
    const double t = met.t.hi();
    if (met.hit.is_yes() && met.t.is_bounded() && met.t.radius() <= 8 * u * t) return hit_at(t, Way::two_words);
    return std::nullopt;
}
Told told(const FirstMet<Running<TwoWords<double>>>& met, double u) {
    if (met.hit.is_no()) return missed(Way::two_words);
    const double t = met.t.first();
    if (met.hit.is_yes() && met.t.radius() <= 8 * u * t) return hit_at(t, Way::two_words);
    return std::nullopt;
}
/// Both ends of t are rounded to double, so that a t that is subnormal, zero or too large is answered too.
Told told(const FirstMet<Interval>& met, double u) {
    if (met.hit.is_no()) return missed(Way::exact);
    if (!met.hit.is_yes() || !met.t.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(met.t.lower(), MPFR_RNDN), high = mpfr_get_d(met.t.upper(), MPFR_RNDN);
    constexpr double tiny = std::numeric_limits<double>::denorm_min();
    if (!(low == high || high - low <= 4 * u * low + tiny)) return std::nullopt;
    return hit_at(low, Way::exact);
}

template <template <class> class S, class E>
Told ask(const double* numbers, double u) {
    const auto number = [numbers](std::size_t i) {
        if constexpr (std::constructible_from<E, double>) return E(numbers[i]);
        else return E(TwoWords<double>(numbers[i]));
    };
    const Ray<E> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    return told(first_met(solid_from<S, E>([&](std::size_t i) { return number(6 + i); }).span(ray)), u);
}

template <template <class> class S, class E>
using SpanOf = decltype(std::declval<const S<E>&>().span(std::declval<const Ray<E>&>()));

template <template <class> class S>
Beyond settle(const double* numbers, double u) {
    if (u > 0x1p-53)
        if (const Told in_double = ask<S, Proving<double>>(numbers, u)) return *in_double;
    using By = Deciding<SpanOf<S, Ball>>;
    if constexpr (By::tries_running_words)
        if (const Told in_two_words = ask<S, Running<TwoWords<double>>>(numbers, u)) return *in_two_words;
    if (const Told in_two_words = ask<S, Ball>(numbers, u)) return *in_two_words;
    for (long bits = 192; bits <= By::enough_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        if (const Told exactly = ask<S, Interval>(numbers, u)) return *exactly;
    }
    return missed(Way::exact);  // the numbers are not a valid primitive
}

template <template <class> class S>
bool are_finite(const double* numbers) {
    for (std::size_t i = 0; i < 6 + row_of(shape_as<S>).numbers; ++i)
        if (!std::isfinite(numbers[i])) return false;
    return numbers[3] != 0 || numbers[4] != 0 || numbers[5] != 0;
}

template <class>
inline constexpr bool is_filtered_by_span = false;
template <class E, template <class> class Span>
requires requires(const Span<E>& s) { first_met(s); }
inline constexpr bool is_filtered_by_span<Span<E>> = true;

}  // namespace

Beyond beyond(Shape shape, const double* numbers, double u) {
    Beyond found = missed(Way::exact);
    Solids::each([&]<template <class> class S>() {
        if constexpr (is_filtered_by_span<SpanOf<S, Ball>>)
            if (shape == shape_as<S> && are_finite<S>(numbers)) found = settle<S>(numbers, u);
    });
    return found;
}

}  // namespace lostbits::intersect::filter
