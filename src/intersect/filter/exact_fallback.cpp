// Decides a ray that a form could not prove. Tries wider and wider arithmetic, each with a bound on its error, until
// one proves the decision and t.
#include "intersect/filter/exact_fallback.hpp"

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "intersect/filter/first_span_hit.hpp"
#include "intersect/filter/first_span_hit_quartic.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "number/wide/proving_number.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::intersect::filter {
namespace {

using number::wide::ProvingNumber, number::wide::RunningError, number::wide::TwoWords;

/// The answer that one arithmetic proves for a ray; empty if it proves none.
using ProvedAnswer = std::optional<FallbackAnswer>;

constexpr FallbackAnswer miss_by(DecidingArithmetic arithmetic) { return {false, -1, arithmetic}; }
/// A hit at t. Adding 0 turns −0 into +0.
constexpr FallbackAnswer hit_by(double t, DecidingArithmetic arithmetic) { return {true, t + 0.0, arithmetic}; }

/// The decision and t, if the decision is proved and the error of t is at most 8 unit_roundoff·t.
ProvedAnswer answer_if_proved(const FirstSpanHit<ProvingNumber<double>>& first_hit, double unit_roundoff) {
    if (first_hit.hit.is_no()) return miss_by(DecidingArithmetic::wider);
    const double t = first_hit.t.word();
    if (first_hit.hit.is_yes() && first_hit.t.radius() <= 8 * unit_roundoff * t)
        return hit_by(t, DecidingArithmetic::wider);
    return std::nullopt;
}
ProvedAnswer answer_if_proved(const FirstSpanHit<Ball>& first_hit, double unit_roundoff) {
    if (first_hit.hit.is_no()) return miss_by(DecidingArithmetic::two_words);
    const double t = first_hit.t.hi();
    if (first_hit.hit.is_yes() && first_hit.t.is_bounded() && first_hit.t.radius() <= 8 * unit_roundoff * t)
        return hit_by(t, DecidingArithmetic::two_words);
    return std::nullopt;
}
ProvedAnswer answer_if_proved(const FirstSpanHit<RunningError<TwoWords<double>>>& first_hit, double unit_roundoff) {
    if (first_hit.hit.is_no()) return miss_by(DecidingArithmetic::two_words);
    const double t = first_hit.t.first();
    if (first_hit.hit.is_yes() && first_hit.t.radius() <= 8 * unit_roundoff * t)
        return hit_by(t, DecidingArithmetic::two_words);
    return std::nullopt;
}
/// Both ends of t are rounded to double, so that a t that is subnormal, zero or too large has an answer too.
ProvedAnswer answer_if_proved(const FirstSpanHit<Interval>& first_hit, double unit_roundoff) {
    if (first_hit.hit.is_no()) return miss_by(DecidingArithmetic::exact);
    if (!first_hit.hit.is_yes() || !first_hit.t.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(first_hit.t.lower(), MPFR_RNDN), high = mpfr_get_d(first_hit.t.upper(), MPFR_RNDN);
    constexpr double tiny = std::numeric_limits<double>::denorm_min();
    if (!(low == high || high - low <= 4 * unit_roundoff * low + tiny)) return std::nullopt;
    return hit_by(low, DecidingArithmetic::exact);
}

template <template <class> class S, class E>
ProvedAnswer try_arithmetic(const double* numbers, double unit_roundoff) {
    const auto number_at = [numbers](std::size_t i) {
        if constexpr (std::constructible_from<E, double>) return E(numbers[i]);
        else return E(TwoWords<double>(numbers[i]));
    };
    const Ray<E> ray{{number_at(0), number_at(1), number_at(2)}, {number_at(3), number_at(4), number_at(5)}};
    return answer_if_proved(
        first_span_hit(primitive_from<S, E>([&](std::size_t i) { return number_at(6 + i); }).span(ray)), unit_roundoff);
}

template <template <class> class S, class E>
using SpanOf = decltype(std::declval<const S<E>&>().span(std::declval<const Ray<E>&>()));

template <template <class> class S>
FallbackAnswer decide_by_escalation(const double* numbers, double unit_roundoff) {
    if (unit_roundoff > 0x1p-53)
        if (const ProvedAnswer proved_in_double = try_arithmetic<S, ProvingNumber<double>>(numbers, unit_roundoff))
            return *proved_in_double;
    using Limits = FallbackLimits<SpanOf<S, Ball>>;
    if constexpr (Limits::tries_running_words)
        if (const ProvedAnswer proved_in_two_words =
                try_arithmetic<S, RunningError<TwoWords<double>>>(numbers, unit_roundoff))
            return *proved_in_two_words;
    if (const ProvedAnswer proved_in_two_words = try_arithmetic<S, Ball>(numbers, unit_roundoff))
        return *proved_in_two_words;
    for (long bits = 192; bits <= Limits::enough_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        if (const ProvedAnswer proved_exactly = try_arithmetic<S, Interval>(numbers, unit_roundoff))
            return *proved_exactly;
    }
    return miss_by(DecidingArithmetic::exact);  // the numbers are not a valid primitive
}

template <template <class> class S>
bool is_valid_input(const double* numbers) {
    for (std::size_t i = 0; i < 6 + row_of(shape_as<S>).number_count; ++i)
        if (!std::isfinite(numbers[i])) return false;
    return numbers[3] != 0 || numbers[4] != 0 || numbers[5] != 0;
}

template <class>
inline constexpr bool is_filtered_by_span = false;
template <class E, template <class> class Span>
requires requires(const Span<E>& s) { first_span_hit(s); }
inline constexpr bool is_filtered_by_span<Span<E>> = true;

}  // namespace

FallbackAnswer exact_fallback(Shape shape, const double* numbers, double unit_roundoff) {
    FallbackAnswer answer = miss_by(DecidingArithmetic::exact);
    Primitives::each([&]<template <class> class S>() {
        if constexpr (is_filtered_by_span<SpanOf<S, Ball>>)
            if (shape == shape_as<S> && is_valid_input<S>(numbers))
                answer = decide_by_escalation<S>(numbers, unit_roundoff);
    });
    return answer;
}

}  // namespace lostbits::intersect::filter
