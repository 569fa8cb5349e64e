// A form that filters by its span: it computes in the arithmetic of T with an error bound, and in wider arithmetic for
// rays that the bound does not decide.
#pragma once

#include <array>
#include <string_view>

#include "intersect/filter/exact_fallback.hpp"
#include "intersect/filter/first_span_hit.hpp"
#include "intersect/filter/first_span_hit_quartic.hpp"
#include "intersect/filter/last_steps.hpp"
#include "number/wide/proving_number.hpp"

namespace lostbits::intersect::filter {

/// The decision and t of a filter, and whether they are proved. P is the number type T without recording.
template <class T, class P>
struct FilterResult {
    mask_t<P> proved, hit;
    T t;
};

/// Filters in the arithmetic of T: if the result is proved, the error of t is at most 62u t. `numbers` are those of the
/// ray, then those of the primitive. The function is not inlined, because rays and many primitives share it. A format
/// of less than 20 bits proves nothing (`ProvingNumber`).
template <template <class> class S, class T, class P>
[[gnu::noinline]] FilterResult<T, P> prove(const T* numbers) {
    using E = number::wide::ProvingNumber<T>;
    const auto number_at = [numbers](std::size_t i) { return E(numbers[i]); };
    const Ray<E> ray{{number_at(0), number_at(1), number_at(2)}, {number_at(3), number_at(4), number_at(5)}};

    const auto first_hit =
        first_span_hit(primitive_from<S, E>([&](std::size_t i) { return number_at(6 + i); }).span(ray));

    const P u = number::wide::roundoff<P>(), t = number::wide::plain_value(first_hit.t.word());
    const mask_t<P> is_fine_enough = P(1024) * u <= P(1) / P(1024), is_accurate = first_hit.t.radius() <= P(62) * u * t;
    return {is_fine_enough && (first_hit.hit.no() || (first_hit.hit.yes() && is_accurate)), first_hit.hit.yes(),
            named("t", first_hit.t.word())};
}

/// x as a double, which holds every number of a rounded format.
template <class T>
double as_double(const T& x) {
    if constexpr (std::floating_point<T>) return x;
    else return as_double(x.value());
}

/// The answer of a form that yields one root.
template <Number T>
Hit<T> single_root_hit(const mask_t<T>& hit, const T& t) {
    return {hit, t, t, t};
}

/// Decides each lane of a pack that is not proved in wider arithmetic, one lane at a time.
template <Number T, std::size_t n, class Watch>
requires number::wide::InRegisters<T> Hit<T> decide_in_wider(std::string_view, Shape shape,
                                                             const std::array<T, n>& numbers,
                                                             const FilterResult<T, T>& known, Watch& watch) {
    constexpr bool narrow = number::wide::has_wider_word<T>;
    using F = std::conditional_t<narrow, float, double>;
    F lanes[n][T::lanes], t[T::lanes], hit[T::lanes];
    bool proved[T::lanes];
    for (std::size_t i = 0; i < n; ++i) numbers[i].store(lanes[i]);
    known.proved.store(proved);
    known.t.store(t);
    select(known.hit, T(1), T(0)).store(hit);

    for (std::size_t lane = 0; lane < T::lanes; ++lane) {
        if (proved[lane]) continue;
        double ray_numbers[n];
        for (std::size_t i = 0; i < n; ++i) ray_numbers[i] = lanes[i][lane];
        const FallbackAnswer answer = exact_fallback(shape, ray_numbers, narrow ? 0x1p-24 : 0x1p-53);
        watch(answer.arithmetic);
        hit[lane] = answer.hit ? F(1) : F(0);
        t[lane] = static_cast<F>(answer.t);
    }
    return single_root_hit(T::load(hit) > T(0), T::load(t));
}

/// Decides a ray that is not proved, for numbers other than packs. Numbers that record operations record a call.
template <Number T, class P, std::size_t n, class Watch>
Hit<T> decide_in_wider(std::string_view form, Shape shape, const std::array<T, n>& numbers, const FilterResult<T, P>&,
                       Watch& watch) {
    double ray_numbers[n];
    for (std::size_t i = 0; i < n; ++i) ray_numbers[i] = as_double(numbers[i]);
    const FallbackAnswer answer = exact_fallback(shape, ray_numbers, as_double(unit_roundoff<P>()));
    watch(answer.arithmetic);

    const P t = static_cast<P>(answer.t);
    if constexpr (traces_operations<T>) {
        using number::wide::record_call;
        const T decision = record_call<T>({form, CallAnswer::decision}, numbers, P(answer.hit ? 1 : -1));
        return single_root_hit(decision > T(0), record_call<T>({form, CallAnswer::t}, numbers, t));
    } else {
        return single_root_hit<T>(answer.hit, t);
    }
}

/// Evaluates the form of this name. `watch(arithmetic)` is called for every arithmetic used after the first.
template <template <class> class S, Number T, class Watch>
Hit<T> by_span(std::string_view form, const Ray<T>& ray, const S<T>& primitive, Watch& watch) {
    if constexpr (is_exact<T>) {
        const FirstSpanHit<T> first_hit = first_span_hit(primitive.span(ray));
        return single_root_hit(first_hit.hit, named("t", first_hit.t));
    } else {
        using P = decltype(number::wide::plain_value(ray.origin.x));
        const auto numbers = inputs_of(ray, primitive);
        const FilterResult<T, P> known = prove<S, T, P>(numbers.data());
        if (any_of(number::wide::constant_mask<T>(!known.proved)))
            return decide_in_wider<T>(form, shape_as<S>, numbers, known, watch);
        return single_root_hit(number::wide::constant_mask<T>(known.hit), known.t);
    }
}

inline constexpr std::string_view title_by_span =
    "from the span of the line inside; proved by a bound, else in wider arithmetic";
inline constexpr std::string_view source_by_span =
    "a running bound after Higham, Accuracy and Stability, 3.3, as a filter after Shewchuk 1997";

/// Implements a form F of the shape S that filters by its span; the `info` of F names the form. Every step has a bound
/// on its rounding error. If the bounds do not prove the decision, or leave t less than 17 correct bits of 24 (46 of
/// 53), the ray is computed again in wider arithmetic: float, double, double-double, intervals. No decision about the
/// closed primitive is wrong (tests/exact). The form yields the first intersection: near = far = t.
template <class F, template <class> class S>
struct SpanFilter {
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const S<T>& primitive) {
        NoWatch watch;
        return intersect(ray, primitive, watch);
    }
    /// Calls `watch(arithmetic)` for every arithmetic used after the first.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const S<T>& primitive, Watch& watch) {
        return by_span<S>(F::info.name, ray, primitive, watch);
    }
};

}  // namespace lostbits::intersect::filter
