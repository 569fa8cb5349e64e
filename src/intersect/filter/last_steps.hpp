// The last steps of `sphere.filtered` and `triangle.filtered`, for rays that no bound decides: two words, exact sums,
// and numbers of any size. A form has its own formulas for them, in a struct `Steps` with
//
// - `name`: the name of the form;
// - `in_two_words(ray, primitive)`: decides in two words, with an error bound;
// - `by_exact_sums(ray, primitive, fit)`: decides by exact sums; the decision is proved where the numbers fit (`fits`);
// - `in_any_range<T>(numbers, answer)`: decides for doubles of any size, one ray at a time. The answer is 1 for a hit
//   or -1 for a miss, then t.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "geometry/ray.hpp"
#include "intersect/deciding_arithmetic.hpp"
#include "number/wide/widening.hpp"
#include "shapes/numbers_of.hpp"

namespace lostbits::intersect::filter {

/// Result of a step for a ray: the decision and t, which are valid only if they are proved.
template <Number T>
struct Decision {
    mask_t<T> is_proved, hit;
    T t;

    /// Returns `first` where it is proved, else `second`. A type that records operations computes one ray at a time and
    /// takes the second step only if the first proved nothing, so `second` is returned.
    friend Decision prefer_first(const Decision& first, const Decision& second) {
        if constexpr (traces_operations<T>) return second;
        else
            return {first.is_proved || second.is_proved,
                    (first.is_proved && first.hit) || (!first.is_proved && second.hit),
                    select(first.is_proved, first.t, second.t)};
    }
};

/// Returns the numbers of a ray, then those of a primitive.
template <template <class> class S, class T>
auto inputs_of(const Ray<T>& ray, const S<T>& primitive) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
        const Vec<T>&o = ray.origin, &d = ray.direction;
        std::array<T, 6 + sizeof...(i)> numbers{o.x, o.y, o.z, d.x, d.y, d.z, (static_cast<void>(i), o.x)...};
        std::size_t k = 6;
        for_each_number(primitive, [&](const T& x) { numbers[k++] = x; });
        return numbers;
    }
    (std::make_index_sequence<number_count<S<T>>>());
}

/// True if every number is 0 or between 2^-160 and 2^160 in size. Then no product of four numbers overflows, and no
/// rounding error of one underflows. Floats always fit. Also true if a number is infinite or NaN, because wider sums
/// would decide no better.
template <template <class> class S, Number T>
mask_t<T> fits(const Ray<T>& ray, const S<T>& primitive) {
    mask_t<T> all_fit = T(0) <= T(0);
    if constexpr (number::wide::products_may_overflow<T>) {
        using Wide = number::wide::OneWord<T>;
        const Wide least = number::wide::power_of_two<Wide>(-160), largest = Wide(1) / least;
        Wide zero_if_finite(0);
        for (const T& x : inputs_of(ray, primitive)) {
            const Wide size = abs(number::wide::widen<Wide>(x));
            all_fit = all_fit && size <= largest && (size >= least || size <= Wide(0));
            zero_if_finite = zero_if_finite + Wide(0) * size;
        }
        all_fit = all_fit || !(zero_if_finite <= Wide(0));
    }
    return all_fit;
}

/// Decides without rounding where `known` is not proved: by exact sums or, for numbers that do not fit, over the whole
/// range of numbers.
template <class Steps, template <class> class S, Number T>
Decision<T> decide_exactly(const Ray<T>& ray, const S<T>& primitive, Decision<T> known) {
    const mask_t<T> fit = fits(ray, primitive);
    if (any_of(!known.is_proved && fit)) known = prefer_first(known, Steps::by_exact_sums(ray, primitive, fit));
    if constexpr (number::wide::products_may_overflow<T>) {
        if (any_of(!known.is_proved)) {
            const std::array<T, 2> answers = number::wide::apply_to_lanes(
                select(known.is_proved, T(0), T(1)), inputs_of(ray, primitive),
                std::array<T, 2>{select(known.hit, T(1), -T(1)), known.t},
                [](const auto& in, auto& out) { Steps::template in_any_range<T>(in, out); });
            return {T(0) <= T(0), answers[0] > T(0), answers[1]};
        }
    }
    return known;
}

/// Does what `decide_exactly` does, for number types that record operations. They have no operation for exact sums, so
/// the step is recorded as a call.
template <class Steps, template <class> class S, Number T>
Decision<T> record_exact_decision(const Ray<T>& ray, const S<T>& primitive) {
    using number::wide::plain_value, number::wide::record_call;
    using Plain = decltype(plain_value(ray.origin.x));
    const Plain zero(0);
    const auto numbers = inputs_of(ray, primitive);
    const Decision<Plain> decision =
        decide_exactly<Steps>(Ray<Plain>{plain_value(ray.origin), plain_value(ray.direction)},
                              primitive_from<S, Plain>([&](std::size_t i) { return plain_value(numbers[6 + i]); }),
                              Decision<Plain>{zero < zero, zero < zero, zero});
    const T decision_call =
        record_call<T>({Steps::name, CallAnswer::decision}, numbers, select(decision.hit, Plain(1), Plain(-1)));
    return {number::wide::constant_mask<T>(decision.is_proved), decision_call > T(0),
            record_call<T>({Steps::name, CallAnswer::t}, numbers, decision.t)};
}

/// Decides where `first` is not proved: in two words, then without rounding.
template <class Steps, template <class> class S, Number T, class Watch>
Decision<T> decide_further(const Ray<T>& ray, const S<T>& primitive, const Decision<T>& first, Watch& watch) {
    watch(DecidingArithmetic::two_words);
    const auto in_two_words = [&] {
        const Part<T> part("in two words");
        return prefer_first(first, Steps::in_two_words(ray, primitive));
    };
    const Decision<T> two_word_decision = in_two_words();
    if (!any_of(!two_word_decision.is_proved)) return two_word_decision;
    watch(DecidingArithmetic::exact);
    if constexpr (traces_operations<T>) return record_exact_decision<Steps>(ray, primitive);
    else return decide_exactly<Steps>(ray, primitive, two_word_decision);
}

/// Does what `decide_further` does, as a function of its own that takes its arguments by value, so that the loops over
/// packs keep their registers.
template <class Steps, template <class> class S, Number T, class Watch>
[[gnu::noinline]] Decision<T> finish(Ray<T> ray, S<T> primitive, Decision<T> first, Watch& watch) {
    return decide_further<Steps>(ray, primitive, first, watch);
}
template <class Steps, template <class> class S, Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] Decision<T> finish(Ray<T> ray, S<T> primitive, Decision<T> first, Watch& watch) {
    return decide_further<Steps>(ray, primitive, first, watch);
}

}  // namespace lostbits::intersect::filter
