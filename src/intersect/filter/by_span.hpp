// A form that filters by its span: in the arithmetic of T with a bound, and beyond it for rays that this leaves open.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "intersect/filter/exact_fallback.hpp"
#include "intersect/filter/first_span_hit.hpp"
#include "intersect/filter/first_span_hit_quartic.hpp"
#include "number/wide/proving.hpp"

namespace lostbits::intersect::filter {

/// The decision and t, if they are proved; P is T without recording.
template <class T, class P>
struct FirstStep {
    mask_t<P> proved, hit;
    T t;
};

/// Filters in the arithmetic of T: t is within 62u of itself. `numbers` are those of the ray and of the primitive. Not
/// inlined: rays and many primitives share it. A format of less than 20 bits proves nothing (`Proving`).
template <template <class> class S, class T, class P>
[[gnu::noinline]] FirstStep<T, P> prove(const T* numbers) {
    using E = number::wide::Proving<T>;
    const auto number = [numbers](std::size_t i) { return E(numbers[i]); };
    const Ray<E> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    const auto met = first_span_hit(primitive_from<S, E>([&](std::size_t i) { return number(6 + i); }).span(ray));
    const P u = number::wide::roundoff_of<P>(), t = number::wide::value_of(met.t.word());
    const mask_t<P> fine = P(1024) * u <= P(1) / P(1024), kept = met.t.radius() <= P(62) * u * t;
    return {fine && (met.hit.no() || (met.hit.yes() && kept)), met.hit.yes(), named("t", met.t.word())};
}

/// x as a double, which holds every number that is rounded.
template <class T>
double as_double(const T& x) {
    if constexpr (std::floating_point<T>) return x;
    else return as_double(x.value());
}

/// One answer in T's numbers.
template <Number T>
Hit<T> answered(const mask_t<T>& hit, const T& t) {
    return {hit, t, t, t};
}

/// Settles the lanes of a pack that are not proved, each by itself.
template <Number T, std::size_t n, class Watch>
requires number::wide::InRegisters<T> Hit<T> settled(std::string_view, Shape shape, const std::array<T, n>& numbers,
                                                     const FirstStep<T, T>& known, Watch& watch) {
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
        double one[n];
        for (std::size_t i = 0; i < n; ++i) one[i] = lanes[i][lane];
        const FallbackAnswer found = exact_fallback(shape, one, narrow ? 0x1p-24 : 0x1p-53);
        watch(found.way);
        hit[lane] = found.hit ? F(1) : F(0);
        t[lane] = static_cast<F>(found.t);
    }
    return answered(T::load(hit) > T(0), T::load(t));
}

/// Settles any other number that is not proved. Numbers that record operations record a call.
template <Number T, class P, std::size_t n, class Watch>
Hit<T> settled(std::string_view form, Shape shape, const std::array<T, n>& numbers, const FirstStep<T, P>&,
               Watch& watch) {
    double one[n];
    for (std::size_t i = 0; i < n; ++i) one[i] = as_double(numbers[i]);
    const FallbackAnswer found = exact_fallback(shape, one, as_double(unit_roundoff<P>()));
    watch(found.way);
    const P t = static_cast<P>(found.t);
    if constexpr (traces_operations<T>) {
        using number::wide::record_call;
        const T decision = record_call<T>({form, CallAnswer::decision}, numbers, P(found.hit ? 1 : -1));
        return answered(decision > T(0), record_call<T>({form, CallAnswer::t}, numbers, t));
    } else {
        return answered<T>(found.hit, t);
    }
}

/// Evaluates the form of this name. `watch(way)` is called for every arithmetic used beyond the first.
template <template <class> class S, Number T, class Watch>
Hit<T> by_span(std::string_view form, const Ray<T>& ray, const S<T>& primitive, Watch& watch) {
    if constexpr (is_exact<T>) {
        const FirstSpanHit<T> met = first_span_hit(primitive.span(ray));
        return answered(met.hit, named("t", met.t));
    } else {
        using P = decltype(number::wide::value_of(ray.origin.x));
        const Vec<T>&o = ray.origin, &d = ray.direction;
        const auto numbers = [&]<std::size_t... i>(std::index_sequence<i...>) {
            std::array<T, 6 + sizeof...(i)> all{o.x, o.y, o.z, d.x, d.y, d.z, (static_cast<void>(i), o.x)...};
            std::size_t k = 6;
            each_number(primitive, [&](const T& x) { all[k++] = x; });
            return all;
        }
        (std::make_index_sequence<row_of(shape_as<S>).numbers>());
        const FirstStep<T, P> known = prove<S, T, P>(numbers.data());
        if (any_of(number::wide::constant_mask<T>(!known.proved)))
            return settled<T>(form, shape_as<S>, numbers, known, watch);
        return answered(number::wide::constant_mask<T>(known.hit), known.t);
    }
}

inline constexpr std::string_view title_by_span =
    "from the span of the line inside; proved by a bound, else in wider arithmetic";
inline constexpr std::string_view source_by_span =
    "a running bound after Higham, Accuracy and Stability, 3.3, as a filter after Shewchuk 1997";

/// Implements such a form F of the shape S; the `info` of F names it. Every step has a bound on its rounding. If that
/// does not prove the decision, or leaves t less than 17 correct bits of 24 (46 of 53), the ray is computed again in
/// wider arithmetic: float, double, double-double, intervals. No wrong decision about the closed primitive
/// (tests/exact). It yields the first intersection: near = far = t.
template <class F, template <class> class S>
struct FiltersBySpan {
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const S<T>& primitive) {
        NoWatch watch;
        return intersect(ray, primitive, watch);
    }
    /// `watch(way)` is called for every arithmetic used beyond the first.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const S<T>& primitive, Watch& watch) {
        return by_span<S>(F::info.name, ray, primitive, watch);
    }
};

}  // namespace lostbits::intersect::filter
