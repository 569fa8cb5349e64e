#include "intersect/filter/exact_fallback.hpp"

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "intersect/filter/first_span_hit.hpp"
#include "intersect/filter/first_span_hit_quartic.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "number/wide/proving.hpp"
#include "number/wide/running.hpp"

namespace lostbits::intersect::filter {
namespace {

using number::wide::Proving, number::wide::Running, number::wide::TwoWords;

/// The answer that one arithmetic proves for a ray; nothing if it proves none.
using ProvedAnswer = std::optional<FallbackAnswer>;

constexpr FallbackAnswer missed(FilterArithmetic way) { return {false, -1, way}; }
/// Adding 0 turns -0 into +0.
constexpr FallbackAnswer hit_at(double t, FilterArithmetic way) { return {true, t + 0.0, way}; }

/// The proved answer: the decision, with t to within 8u of itself.
ProvedAnswer proved_answer(const FirstSpanHit<Proving<double>>& met, double u) {
    if (met.hit.is_no()) return missed(FilterArithmetic::wider);
    const double t = met.t.word();
    if (met.hit.is_yes() && met.t.radius() <= 8 * u * t) return hit_at(t, FilterArithmetic::wider);
    return std::nullopt;
}
ProvedAnswer proved_answer(const FirstSpanHit<Ball>& met, double u) {
    if (met.hit.is_no()) return missed(FilterArithmetic::two_words);
    const double t = met.t.hi();
    if (met.hit.is_yes() && met.t.is_bounded() && met.t.radius() <= 8 * u * t)
        return hit_at(t, FilterArithmetic::two_words);
    return std::nullopt;
}
ProvedAnswer proved_answer(const FirstSpanHit<Running<TwoWords<double>>>& met, double u) {
    if (met.hit.is_no()) return missed(FilterArithmetic::two_words);
    const double t = met.t.first();
    if (met.hit.is_yes() && met.t.radius() <= 8 * u * t) return hit_at(t, FilterArithmetic::two_words);
    return std::nullopt;
}
/// Both ends of t are rounded to double, so that a t that is subnormal, zero or too large is answered too.
ProvedAnswer proved_answer(const FirstSpanHit<Interval>& met, double u) {
    if (met.hit.is_no()) return missed(FilterArithmetic::exact);
    if (!met.hit.is_yes() || !met.t.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(met.t.lower(), MPFR_RNDN), high = mpfr_get_d(met.t.upper(), MPFR_RNDN);
    constexpr double tiny = std::numeric_limits<double>::denorm_min();
    if (!(low == high || high - low <= 4 * u * low + tiny)) return std::nullopt;
    return hit_at(low, FilterArithmetic::exact);
}

template <template <class> class S, class E>
ProvedAnswer proved_by(const double* numbers, double u) {
    const auto number = [numbers](std::size_t i) {
        if constexpr (std::constructible_from<E, double>) return E(numbers[i]);
        else return E(TwoWords<double>(numbers[i]));
    };
    const Ray<E> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    return proved_answer(first_span_hit(primitive_from<S, E>([&](std::size_t i) { return number(6 + i); }).span(ray)),
                         u);
}

template <template <class> class S, class E>
using SpanOf = decltype(std::declval<const S<E>&>().span(std::declval<const Ray<E>&>()));

template <template <class> class S>
FallbackAnswer settle(const double* numbers, double u) {
    if (u > 0x1p-53)
        if (const ProvedAnswer in_double = proved_by<S, Proving<double>>(numbers, u)) return *in_double;
    using By = Deciding<SpanOf<S, Ball>>;
    if constexpr (By::tries_running_words)
        if (const ProvedAnswer in_two_words = proved_by<S, Running<TwoWords<double>>>(numbers, u)) return *in_two_words;
    if (const ProvedAnswer in_two_words = proved_by<S, Ball>(numbers, u)) return *in_two_words;
    for (long bits = 192; bits <= By::enough_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        if (const ProvedAnswer exactly = proved_by<S, Interval>(numbers, u)) return *exactly;
    }
    return missed(FilterArithmetic::exact);  // the numbers are not a valid primitive
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
requires requires(const Span<E>& s) { first_span_hit(s); }
inline constexpr bool is_filtered_by_span<Span<E>> = true;

}  // namespace

FallbackAnswer exact_fallback(Shape shape, const double* numbers, double u) {
    FallbackAnswer found = missed(FilterArithmetic::exact);
    Primitives::each([&]<template <class> class S>() {
        if constexpr (is_filtered_by_span<SpanOf<S, Ball>>)
            if (shape == shape_as<S> && are_finite<S>(numbers)) found = settle<S>(numbers, u);
    });
    return found;
}

}  // namespace lostbits::intersect::filter
