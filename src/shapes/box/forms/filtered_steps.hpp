// The steps of `box.filtered`, and the inequalities that let a ray stop at a step.
#pragma once

#include "geometry/vec.hpp"
#include "intersect/deciding_arithmetic.hpp"
#include "number/wide/dyadic_slabs.hpp"
#include "shapes/box/forms/filtered_words.hpp"

namespace lostbits::intersect::box {
namespace filtered {

/// Decision of the first step. `in_range` is true if its tmin and tmax are accurate.
template <Number T>
struct BoundDecision : SlabDecision<T> {
    mask_t<T> in_range;
};

/// Decides by tmin and tmax alone. Each of them is zero, the ray's end, or t = (plane − o)·(1/d) with three roundings.
/// L is the least normal number. The errors are:
///
///     plane − o                error ≤ u |plane − o|, since no sum underflows
///     1/d, normal              error ≤ u |1/d|, so the error of t is at most 3.1u |t|
///     1/d, subnormal           L/4 ≤ |1/d| < L, since |d| > 1/L
///                              error ≤ 4u |1/d|, so the error of t is at most 6.1u |t|
///     product that underflows  error of t ≤ 6.1u |t| + uL; the computed t has the sign of t, or is ±0
///
/// If plane − o, 1/d or the product overflows, then dmax, the later t of a slab, is ±∞ or NaN:
///
///     dmax = −∞                the sign is right, so the ray is missed (dmin = −∞ is right too, and is not examined)
///     dmax = +∞                `overflow_sum`, the sum of all dmax, is ∞ or NaN
///     dmax = NaN, from 0·∞     `overflow_sum` is NaN
///
/// d = 0 also makes dmax infinite or NaN. `largest_intermediate` then shows if anything overflowed. If `overflow_sum`
/// is less than ∞, these inequalities are proofs:
///
///     of a hit                 tmin (1 + 6.1u) + uL ≤ tmax (1 − 6.1u) − uL
///     of a miss                tmin (1 − 6.1u) − uL > tmax (1 + 6.1u) + uL
///
/// The function makes stricter tests, which allow for their own roundings, and hold for either sign of tmax:
///
///     of a hit                 tmin < tmax (1 − 16u) − L
///     of a miss                tmin > tmax (1 + 16u) + L
///
/// A slab that is parallel to the ray has two infinite t: of one sign if the ray is outside the slab, and −∞ and ∞ if
/// it is inside. For a ray in one of the planes, 0·∞ is NaN, which leaves tmin and tmax as they were. For a direction
/// of zeros, tmin and tmax may both be ∞; then neither test holds, and the ray is left undecided. The errors of tmin
/// and tmax are at most 6.1u |tmin| and 6.1u |tmax|, or the distance between subnormal numbers.
template <Number T>
BoundDecision<T> decide_by_bound(const T& tmin, const T& tmax, const T& overflow_sum) {
    if constexpr (traces_operations<T>) {
        using number::wide::plain_value, number::wide::constant_mask;
        const auto plain_decision = decide_by_bound(plain_value(tmin), plain_value(tmax), plain_value(overflow_sum));
        return {{constant_mask<T>(plain_decision.is_proved), tmin <= tmax}, constant_mask<T>(plain_decision.in_range)};
    } else {
        const T margin = T(16) * unit_roundoff<T>(), least = number::wide::smallest_normal<T>();
        const mask_t<T> in_range = overflow_sum < T(1) / T(0);
        const mask_t<T> is_hit = in_range && tmin < tmax * (T(1) - margin) - least;
        const mask_t<T> is_miss = in_range && tmin > tmax * (T(1) + margin) + least;
        return {{is_hit || is_miss, is_hit}, in_range};
    }
}

template <Number T, class B>
OrderedSlabs<T> order_planes(const Ray<T>& ray, const B& box) {
    const auto planes_at = [&](int axis) { return planes_by_sign<T>(box, axis, T(1) / ray.direction[axis]); };
    return {{planes_at(0), planes_at(1), planes_at(2)}};
}

/// The tmin and tmax of the first step, and the ray's end.
template <Number T>
struct SlabResult {
    Segment<T> segment;
    T limit;
};

/// Returns the largest of these two values over the axes. If nothing overflows, each has a relative error of at
/// most 7u:
///
///     dmax |d|    is plane − o, or its negative
///     (1/d) d     is 1
///
/// The result is ∞ if dmax is +∞ because a sum or a product overflowed, or if 1/d overflowed: then (1/d) d is ∞, also
/// if dmax is NaN from 0·∞. For a slab with d = 0 both values are NaN, which max leaves out.
template <Number T>
T largest_intermediate(const Ray<T>& ray, const OrderedSlabs<T>& slabs) {
    T largest(0);
    for (int axis = 0; axis < 3; ++axis) {
        const T d = ray.direction[axis], inv = T(1) / d;
        const T dmax = (slabs.planes[axis].second - ray.origin[axis]) * inv;
        largest = max(inv * d, max(dmax * abs(d), largest));
    }
    return largest;
}

/// True if each number x is 0 or satisfies 2^-450 ≤ |x| ≤ 2^500. Then the product of two numbers does not overflow in
/// double, and the product of their last places does not underflow. Floats always fit.
template <Number T>
mask_t<T> fits(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    if constexpr (traces_operations<T>) {
        using number::wide::plain_value;
        return number::wide::constant_mask<T>(fits<decltype(plain_value(limit))>(
            {plain_value(ray.origin), plain_value(ray.direction)}, plain_value(slabs), plain_value(limit)));
    }

    mask_t<T> all_fit = T(0) <= T(0);
    if constexpr (number::wide::products_may_overflow<T>) {
        using B = number::wide::OneWord<T>;
        const B least = number::wide::power_of_two<B>(-450), largest = B(1) / number::wide::power_of_two<B>(-500);
        const auto check_size = [&](const T& x) {
            const B size = abs(number::wide::widen<B>(x));
            all_fit = all_fit && size <= largest && (size >= least || size <= B(0));
        };

        for (int axis = 0; axis < 3; ++axis) {
            check_size(ray.origin[axis]);
            check_size(ray.direction[axis]);
            check_size(slabs.planes[axis].first);
            check_size(slabs.planes[axis].second);
        }
        const mask_t<B> is_endless = number::wide::widen<B>(limit) >= beyond_every_t<B>();
        check_size(select(is_endless, T(0), limit));
    }
    return all_fit;
}

/// Decides in W, rounded to nearest, by the comparisons n m ≤ f g of `join_all_pairs`. With v the unit roundoff of W, n
/// and f round once and the products once more, so n m and f g have relative errors of at most 2.1v. Then n m ≤ f g is
/// proved if n m + 3v(|n m| + |f g|) ≤ f g, also if both are zero. Infinite planes make NaN, which decides nothing.
///
/// The function is `static`, so that the linker does not use a copy that another file compiled for wide registers.
template <class W, Number T>
static SlabDecision<T> decide_in_wider(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using number::wide::narrow, number::wide::widen;
    const auto widen_number = [](const T& x) { return widen<W>(x); };
    std::array<W, 3> m{W(0), W(0), W(0)}, n = m, f = m;
    for (int axis = 0; axis < 3; ++axis) {
        const W d = widen_number(ray.direction[axis]), o = widen_number(ray.origin[axis]);
        const W sign = copysign(W(1), d);
        m[axis] = abs(d);
        n[axis] = sign * (widen_number(slabs.planes[axis].first) - o);
        f[axis] = sign * (widen_number(slabs.planes[axis].second) - o);
    }
    const W v = unit_roundoff<W>(), end = min(widen_number(limit), beyond_every_t<W>());

    // 1 if the comparison is proved to hold, −1 if it is proved to fail, else 0. The least over all comparisons
    // decides.
    const auto proved_sign = [&](const W& lesser, const W& greater) {
        const W difference = greater - lesser, margin = W(3) * v * (abs(lesser) + abs(greater));
        return select(difference >= margin, W(1), select(difference <= -margin, W(-1), W(0)));
    };
    const auto sign_of = [](const W& x) { return select(x >= W(0), W(1), W(-1)); };
    W least_sign = sign_of(end);
    for (int i = 0; i < 3; ++i) {
        const auto from = static_cast<std::size_t>(i);
        least_sign = min(least_sign, sign_of(f[from]));
        least_sign = min(least_sign, proved_sign(n[from], end * m[from]));
    }
    least_sign = join_all_pairs<W>(
        [&](int i, int j) {
            const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            return proved_sign(n[from] * m[to], f[to] * m[from]);
        },
        [](const W& a, const W& b) { return min(a, b); }, least_sign);

    const T narrowed_sign = narrow<T>(least_sign);
    return {narrowed_sign > T(0) || narrowed_sign < T(0), narrowed_sign >= T(0)};
}

/// Computes tmin and tmax in W, in which nothing overflows or underflows. Narrowed to T, they are accurate to u.
template <class W, Number T>
static Segment<T> segment_in(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using number::wide::narrow, number::wide::widen;
    W tmin(0), tmax = widen<W>(limit);
    for (int axis = 0; axis < 3; ++axis) {
        const Planes<T>& planes = slabs.planes[axis];
        const W d = widen<W>(ray.direction[axis]), o = widen<W>(ray.origin[axis]);
        const mask_t<W> is_moving = abs(d) > W(0);
        tmin = select(is_moving, max((widen<W>(planes.first) - o) / d, tmin), tmin);
        tmax = select(is_moving, min((widen<W>(planes.second) - o) / d, tmax), tmax);
    }
    return {narrow<T>(tmin), narrow<T>(tmax)};
}

/// Decides the rays that `known_decision` does not prove by `meet_slabs`, which takes doubles of any magnitude. A ray
/// that `known_decision` proves keeps its decision. `meet_slabs` also computes tmin and tmax of a ray that is neither
/// proved nor `is_accurate`. All other rays keep tmin and tmax of `result`.
template <Number T>
Hit<T> decide_in_every_range(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const SlabResult<T>& result,
                             const SlabDecision<T>& known_decision, const mask_t<T>& is_accurate) {
    const Vec<T>&o = ray.origin, &d = ray.direction;
    const auto& [x, y, z] = slabs.planes;
    const std::array<T, 13> inputs{o.x,     o.y,     o.z,      d.x,      d.y,      d.z,         x.first,
                                   y.first, z.first, x.second, y.second, z.second, result.limit};
    const std::array<T, 3> answers = number::wide::apply_to_lanes<T, 13, 3>(
        select(known_decision.is_proved, T(0), T(1)), inputs,
        {select(known_decision.hit, T(1), -T(1)), result.segment.tmin, result.segment.tmax},
        number::wide::meet_slabs<T>);
    const Segment<T>& segment = result.segment;
    return hit_from_segment<T>(answers[0] > T(0), {select(is_accurate, segment.tmin, answers[1]),
                                                   select(is_accurate, segment.tmax, answers[2])});
}

/// Decides the rays that `first_decision` does not prove, without rounding: numbers that fit by products and sums of
/// two words or by exact sums, all others by `decide_in_every_range`. tmin and tmax are those of `result`, unless
/// `decide_in_every_range` computes them because `first_decision.in_range` is false.
template <Number T>
Hit<T> decide_exactly(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const SlabResult<T>& result,
                      const BoundDecision<T>& first_decision) {
    using B = number::wide::OneWord<T>;
    SlabDecision<T> known_decision = first_decision;
    const mask_t<T> fit = fits(ray, slabs, result.limit);
    if (any_of(!known_decision.is_proved && fit)) {
        const PlaneDistances<B> distances = plane_distances<T>(ray, slabs, result.limit);
        SlabDecision<T> products = decide_by_products<T>(distances);
        products.is_proved = products.is_proved && fit;
        known_decision = prefer_first(known_decision, products);
        if (any_of(!known_decision.is_proved && fit))
            known_decision = prefer_first(known_decision, decide_by_exact_sums<T>(distances, fit));
    }
    if constexpr (number::wide::products_may_overflow<T>)
        if (any_of(!known_decision.is_proved))
            return decide_in_every_range<T>(ray, slabs, result, known_decision, first_decision.in_range);
    return hit_from_segment<T>(known_decision.hit, result.segment);
}

/// Does what `decide_exactly` does, for number types that record operations. They have no operation for exact sums, so
/// the step is recorded as a call.
template <Number T>
Hit<T> record_exact_decision(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const SlabResult<T>& result,
                             const mask_t<T>& in_range) {
    using number::wide::record_call, number::wide::plain_value;
    using P = decltype(plain_value(result.limit));
    const P zero(0), tmin = plain_value(result.segment.tmin), tmax = plain_value(result.segment.tmax);
    const Hit<P> decision =
        decide_exactly<P>({plain_value(ray.origin), plain_value(ray.direction)}, plain_value(slabs),
                          {{tmin, tmax}, plain_value(result.limit)}, {{zero < zero, zero < zero}, in_range.value()});

    // Collects the inputs of the call. The sign of d exchanges the planes of a slab.
    const Vec<T>&o = ray.origin, &d = ray.direction;
    const auto plane = [&](int axis, const auto& is_exchanged) {
        const Planes<T>& planes = slabs.planes[axis];
        return select(is_exchanged(d[axis]), planes.second, planes.first);
    };
    const auto low = [&](int axis) { return plane(axis, [](const T& x) { return copysign(T(1), x) < T(0); }); };
    const auto high = [&](int axis) { return plane(axis, [](const T& x) { return copysign(T(1), x) > T(0); }); };
    const std::array<T, 13> inputs{o.x,    o.y,    o.z,     d.x,     d.y,     d.z,         low(0),
                                   low(1), low(2), high(0), high(1), high(2), result.limit};

    // Records the answers that the call changes.
    const auto recorded_answer = [&inputs](CallAnswer answer, const P& value) {
        return record_call<T>({"box.filtered", answer}, inputs, value);
    };
    const mask_t<T> hit = recorded_answer(CallAnswer::decision, select(decision.hit, P(1), P(-1))) > T(0);
    const auto is_identical = [](const P& a, const P& b) { return a == b && copysign(P(1), a) == copysign(P(1), b); };
    if (any_of(in_range.value() || (is_identical(decision.near, tmin) && is_identical(decision.far, tmax))))
        return hit_from_segment<T>(hit, result.segment);
    return hit_from_segment<T>(
        hit, {recorded_answer(CallAnswer::near, decision.near), recorded_answer(CallAnswer::far, decision.far)});
}

/// Decides by the planes where `bound_decision` is not proved: in the wider arithmetic of one word if there is one,
/// then without rounding.
template <Number T, class Watch>
Hit<T> decide_further(const Ray<T>& ray, const OrderedSlabs<T>& slabs, SlabResult<T> result,
                      const BoundDecision<T>& bound_decision, Watch& watch) {
    const Part<T> part("by planes");
    BoundDecision<T> known_decision = bound_decision;

    // Tests the range again, since a direction with a zero also makes the sum of the first test infinite.
    if (any_of(!bound_decision.in_range)) {
        const BoundDecision<T> second_decision =
            decide_by_bound<T>(result.segment.tmin, result.segment.tmax, largest_intermediate(ray, slabs));
        known_decision = {prefer_first(bound_decision, second_decision),
                          bound_decision.in_range || second_decision.in_range};
        if (!any_of(!known_decision.is_proved)) return hit_from_segment<T>(known_decision.hit, result.segment);
    }

    // Then in the wider arithmetic. Its segment replaces the one whose numbers left their range.
    if constexpr (number::wide::has_wider_word<T>) {
        if (number::wide::widens<T>()) {
            using B = number::wide::OneWord<T>;
            watch(DecidingArithmetic::wider);
            SlabDecision<T> wide_decision = decide_in_wider<B, T>(ray, slabs, result.limit);
            wide_decision.is_proved = wide_decision.is_proved && fits(ray, slabs, result.limit);
            known_decision = {prefer_first(known_decision, wide_decision), known_decision.in_range};
            if (any_of(!known_decision.in_range)) {
                const Segment<T> wide_segment = segment_in<B, T>(ray, slabs, result.limit);
                result.segment = {select(known_decision.in_range, result.segment.tmin, wide_segment.tmin),
                                  select(known_decision.in_range, result.segment.tmax, wide_segment.tmax)};
            }
            if (!any_of(!known_decision.is_proved)) return hit_from_segment<T>(known_decision.hit, result.segment);
        }
    }

    // Then without rounding.
    watch(DecidingArithmetic::exact);
    if constexpr (traces_operations<T>) return record_exact_decision<T>(ray, slabs, result, known_decision.in_range);
    else return decide_exactly<T>(ray, slabs, result, known_decision);
}

/// Does what `decide_further` does, as a function of its own that takes its arguments by value, so that the loops over
/// packs keep their registers.
template <Number T, class Watch>
[[gnu::noinline]] Hit<T> decide_by_planes(Ray<T> ray, OrderedSlabs<T> slabs, SlabResult<T> result,
                                          BoundDecision<T> bound_decision, Watch& watch) {
    return decide_further<T>(ray, slabs, result, bound_decision, watch);
}
template <Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] Hit<T> decide_by_planes(Ray<T> ray, OrderedSlabs<T> slabs, SlabResult<T> result,
                                                        BoundDecision<T> bound_decision, Watch& watch) {
    return decide_further<T>(ray, slabs, result, bound_decision, watch);
}

}  // namespace filtered
}  // namespace lostbits::intersect::box
