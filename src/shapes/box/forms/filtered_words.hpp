// The exact steps of `box.filtered`: distances to the planes as sums of two words, and comparisons of their products.
#pragma once

#include "geometry/vec.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"
#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {
namespace filtered {

/// Result of a step for a ray: the decision, which is valid only if it is proved.
template <Number T>
struct SlabDecision {
    mask_t<T> is_proved, hit;

    /// Returns `first` where it is proved, else `second`. A type that records operations computes one ray, for which
    /// the second step was taken because the first proved nothing, so it returns `second`.
    friend SlabDecision prefer_first(const SlabDecision& first, const SlabDecision& second) {
        if constexpr (traces_operations<T>) return second;
        else
            return {first.is_proved || second.is_proved,
                    (first.is_proved && first.hit) || (!first.is_proved && second.hit)};
    }
};

/// A box's planes in the order in which the line meets them, which depends on the sign of d.
template <Number T>
struct OrderedSlabs {
    std::array<Planes<T>, 3> planes;
};

/// Returns the slabs in plain numbers.
template <Number T>
auto plain_value(const OrderedSlabs<T>& slabs) {
    using P = decltype(number::wide::plain_value(slabs.planes[0].first));
    const auto planes = [](const Planes<T>& slab) {
        return Planes<P>{number::wide::plain_value(slab.first), number::wide::plain_value(slab.second)};
    };
    return OrderedSlabs<P>{{planes(slabs.planes[0]), planes(slabs.planes[1]), planes(slabs.planes[2])}};
}

/// Returns a number larger than every t of floats, or of numbers in the range of `fits`.
template <Number W>
W beyond_every_t() {
    return W(1) / number::wide::power_of_two<W>(-960);
}

/// Returns x, or, for an infinite x, a larger number than any that `fits`, but with finite products.
template <Number W>
W without_infinity(const W& x) {
    const W largest = W(1) / number::wide::power_of_two<W>(-510);
    return max(-largest, min(largest, x));
}

/// Tests n_i/m_i ≤ f_j/m_j for each pair of axes i ≠ j, as n_i m_j ≤ f_j m_i. On each axis, m = |d|, and n and f are
/// the distances to the first and the second plane, times the sign of d. If m_i = 0, the tests say n_i ≤ 0 and f_i ≥ 0,
/// so a ray in a plane is inside. On one axis n ≤ f always holds. The ends of the ray add the tests f_j ≥ 0 and n_i ≤
/// limit m_i, which are not made here.
///
/// `test(i, j)` answers the test for axes i and j, and `join` combines the answers.
template <class V, class Test, class Join>
V join_all_pairs(const Test& test, const Join& join, V answer) {
    for (int i = 0; i < 3; ++i) {
        answer = join(answer, test(i, (i + 1) % 3));
        answer = join(answer, test(i, (i + 2) % 3));
    }
    return answer;
}

/// n, f and m of `join_all_pairs`. The distances n and f are exact sums of two words; an infinite plane is replaced as
/// in `without_infinity`. `end` is the ray's end, or 0 if the ray is `is_endless`.
template <class B>
struct PlaneDistances {
    std::array<B, 3> m;
    std::array<number::wide::TwoWords<B>, 3> n, f;
    B end;
    mask_t<B> is_endless;

    /// Returns n_i, or 0 if an endless ray moves along the axis.
    [[nodiscard]] number::wide::TwoWords<B> before_end(std::size_t i) const {
        return select(is_endless && m[i] > B(0), number::wide::TwoWords<B>(0), n[i]);
    }
};

template <Number T>
auto plane_distances(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using B = number::wide::OneWord<T>;
    using number::wide::sum_of, number::wide::TwoWords;
    const auto widen = [](const T& x) { return number::wide::widen<B>(x); };
    const TwoWords<B> zero(0);
    const B end = widen(limit);
    const mask_t<B> is_endless = end >= beyond_every_t<B>();
    PlaneDistances<B> distances{
        {B(0), B(0), B(0)}, {zero, zero, zero}, {zero, zero, zero}, select(is_endless, B(0), end), is_endless};

    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const B d = widen(ray.direction[axis]), o = widen(ray.origin[axis]), sign = copysign(B(1), d);
        const TwoWords<B> first = sum_of<B>(without_infinity(widen(slabs.planes[k].first)), -o),
                          second = sum_of<B>(without_infinity(widen(slabs.planes[k].second)), -o);
        distances.m[k] = abs(d);
        distances.n[k] = {sign * first.hi, sign * first.lo};
        distances.f[k] = {sign * second.hi, sign * second.lo};
    }
    return distances;
}

/// Decides by products of two words, where the numbers fit (`fits`). This step decides most rays through an edge, since
/// plane − o of floats is a double. Let the words of the distances be n + n' and f + f', let n m = p + p' and f g = q +
/// q' exactly, and let v be the roundoff. Then (n + n') m ≤ (f + f') g is decided as follows:
///
///     n' = f' = 0   n m ≤ f g exactly where p < q, or p = q and p' ≤ q', since rounding keeps order
///     else          f g − n m = (s + e) + ((q' − p') + (f' g − n' m)), where s + e = q − p exactly. Each of the four
///                   small terms is at most v(1 + v) of p or q, e is at most v of both, and their sum takes five
///                   roundings: off by less than 9 v² (|p| + |q|), so that 20 v² prove a sign
template <Number T>
static SlabDecision<T> decide_by_products(const PlaneDistances<number::wide::OneWord<T>>& distances) {
    using B = number::wide::OneWord<T>;
    using number::wide::product_of, number::wide::sum_of, number::wide::TwoWords;
    const B v = unit_roundoff<B>(), margin = B(20) * v * v;
    B low_words(0);
    for (std::size_t i = 0; i < 3; ++i) low_words = low_words + abs(distances.n[i].lo) + abs(distances.f[i].lo);
    const mask_t<B> are_exact = low_words <= B(0);

    mask_t<B> hit = B(0) <= distances.end, is_miss = !hit;
    const auto compare = [&](const TwoWords<B>& lesser, const B& m, const TwoWords<B>& greater, const B& g) {
        const TwoWords<B> p = product_of(lesser.hi, m), q = product_of(greater.hi, g), s = sum_of<B>(q.hi, -p.hi);
        const B difference = s.hi + (s.lo + ((q.lo - p.lo) + (greater.lo * g - lesser.lo * m)));
        const B bound = margin * (abs(p.hi) + abs(q.hi));
        hit = hit && ((are_exact && p <= q) || (!are_exact && difference >= bound));
        is_miss = is_miss || (are_exact && p > q) || (!are_exact && difference < -bound);
    };

    // Each slab must end at or after 0, and begin before the ray ends and before the other slabs end.
    for (std::size_t i = 0; i < 3; ++i) {
        hit = hit && distances.f[i].hi >= B(0);
        is_miss = is_miss || distances.f[i].hi < B(0);
        compare(distances.before_end(i), B(1), TwoWords<B>(distances.end), distances.m[i]);
        for (std::size_t j = 1; j < 3; ++j) {
            const std::size_t k = (i + j) % 3;
            compare(distances.n[i], distances.m[k], distances.f[k], distances.m[i]);
        }
    }

    const T narrowed_sign = number::wide::narrow<T>(select(hit, B(1), select(is_miss, B(-1), B(0))));
    const mask_t<T> is_positive = narrowed_sign > T(0);
    const mask_t<T> is_negative = narrowed_sign < T(0);
    return {is_positive || is_negative, is_positive};
}

/// Decides exactly where the numbers fit (`fit`), by the signs of exact sums: 1 if every comparison holds, −1 if one
/// fails.
template <Number T>
[[gnu::noinline]] static SlabDecision<T> decide_by_exact_sums(const PlaneDistances<number::wide::OneWord<T>>& distances,
                                                              const mask_t<T>& fit) {
    using B = number::wide::OneWord<T>;
    using number::wide::ExactSum;
    const auto sign_of = [](const B& x) { return select(x >= B(0), B(1), B(-1)); };
    B least_sign = sign_of(distances.end);
    for (std::size_t i = 0; i < 3; ++i) {
        least_sign = min(least_sign, sign_of(distances.f[i].hi));
        ExactSum<B, 4> before_end;
        before_end.add_product(distances.end, distances.m[i]);
        before_end.add(-distances.before_end(i));
        least_sign = min(least_sign, sign_of(before_end.value()));
    }

    least_sign = join_all_pairs<B>(
        [&](int i, int j) {
            const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            ExactSum<B, 8> difference;
            difference.add_product(distances.f[to].hi, distances.m[from]);
            difference.add_product(distances.f[to].lo, distances.m[from]);
            difference.add_product(-distances.n[from].hi, distances.m[to]);
            difference.add_product(-distances.n[from].lo, distances.m[to]);
            return sign_of(difference.value());
        },
        [](const B& a, const B& b) { return min(a, b); }, least_sign);
    return {fit, number::wide::narrow<T>(least_sign) > T(0)};
}

}  // namespace filtered
}  // namespace lostbits::intersect::box
