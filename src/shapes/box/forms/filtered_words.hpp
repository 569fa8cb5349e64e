// The exact steps of `box.filtered`: the distances to its planes as sums of two words, and comparisons of their
// products.
#pragma once

#include "geometry/vec.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"
#include "shapes/box/forms/slab.hpp"

namespace lostbits::intersect::box {
namespace filtered {

/// The result of a step for a ray: the decision if it is proved, else nothing.
template <Number T>
struct SlabDecision {
    mask_t<T> proved, hit;

    /// Returns `first` where it is proved, else `second`. A number that records operations belongs to one ray, which
    /// needed the second step because the first one proved nothing.
    friend SlabDecision joined(const SlabDecision& first, const SlabDecision& second) {
        if constexpr (traces_operations<T>) return second;
        else return {first.proved || second.proved, (first.proved && first.hit) || (!first.proved && second.hit)};
    }
};

/// A box's planes in the order in which the line meets them, which depends on the sign of d.
template <Number T>
struct OrderedSlabs {
    std::array<Planes<T>, 3> planes;
};

/// The same as plain numbers.
template <Number T>
auto value_of(const OrderedSlabs<T>& slabs) {
    using P = decltype(number::wide::value_of(slabs.planes[0].bmin));
    const auto planes = [](const Planes<T>& of) {
        return Planes<P>{number::wide::value_of(of.bmin), number::wide::value_of(of.bmax)};
    };
    return OrderedSlabs<P>{{planes(slabs.planes[0]), planes(slabs.planes[1]), planes(slabs.planes[2])}};
}

/// A number beyond every t of floats, or of numbers in the range of `fits`.
template <Number W>
W far_away() {
    return W(1) / number::wide::power_of_two<W>(-960);
}

/// Returns x. An infinite x becomes a number beyond all that `fits`, whose products are finite.
template <Number W>
W without_infinity(const W& x) {
    const W most = W(1) / number::wide::power_of_two<W>(-510);
    return max(-most, min(most, x));
}

/// Tests n_i/m_i ≤ f_j/m_j for each pair of axes, as n_i m_j ≤ f_j m_i. n and f are the distances to the first and the
/// second plane and m = |d|, all with the sign of d taken out. The test stays true for m = 0, where it says n_i ≤ 0 ≤
/// f_i, so a ray in a plane is inside. On one axis n ≤ f always holds. The ray's own ends add f_j ≥ 0 and n_i ≤ limit
/// m_i.
///
/// `below(i, j)` answers the test for axes i and j; `join` combines the answers.
template <class V, class Below, class Join>
V every_pair(const Below& below, const Join& join, V all) {
    for (int i = 0; i < 3; ++i) {
        all = join(all, below(i, (i + 1) % 3));
        all = join(all, below(i, (i + 2) % 3));
    }
    return all;
}

/// n, f and m, with the distances exact as a sum of two words, and infinite planes replaced by a number beyond all
/// that `fits`. `end` is the ray's end, or 0 where it is `endless`.
template <class B>
struct Ways {
    std::array<B, 3> m;
    std::array<number::wide::TwoWords<B>, 3> n, f;
    B end;
    mask_t<B> endless;

    /// n_i, or 0 if an endless ray moves along the axis.
    [[nodiscard]] number::wide::TwoWords<B> before_end(std::size_t i) const {
        return select(endless && m[i] > B(0), number::wide::TwoWords<B>(0), n[i]);
    }
};

template <Number T>
auto ways_of(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using B = number::wide::OneWord<T>;
    using number::wide::sum_of, number::wide::TwoWords;
    const auto word = [](const T& x) { return number::wide::widen<B>(x); };
    const TwoWords<B> none(0);
    const B end = word(limit);
    const mask_t<B> endless = end >= far_away<B>();
    Ways<B> ways{{B(0), B(0), B(0)}, {none, none, none}, {none, none, none}, select(endless, B(0), end), endless};
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        const B d = word(ray.direction[axis]), o = word(ray.origin[axis]), sign = copysign(B(1), d);
        const TwoWords<B> first = sum_of<B>(without_infinity(word(slabs.planes[at].bmin)), -o),
                          second = sum_of<B>(without_infinity(word(slabs.planes[at].bmax)), -o);
        ways.m[at] = abs(d);
        ways.n[at] = {sign * first.hi, sign * first.lo};
        ways.f[at] = {sign * second.hi, sign * second.lo};
    }
    return ways;
}

/// Decides by products of two words, where the numbers `fit`. Most rays through an edge end here, since plane − o of
/// floats is a double. With n = (n, n') and f = (f, f'), n m = p + p' and f g = q + q' exactly, and v the roundoff:
///
///     n' = f' = 0   n m ≤ f g exactly where p < q, or p = q and p' ≤ q', since rounding keeps order
///     else          f g − n m = (s + e) + ((q' − p') + (f' g − n' m)), where s + e = q − p exactly. Each of the four
///                   small terms is at most v(1 + v) of p or q, e is at most v of both, and their sum takes five
///                   roundings: off by less than 9 v² (|p| + |q|), so that 20 v² prove a sign
template <Number T>
static SlabDecision<T> by_products(const Ways<number::wide::OneWord<T>>& ways) {
    using B = number::wide::OneWord<T>;
    using number::wide::product_of, number::wide::sum_of, number::wide::TwoWords;
    const B v = unit_roundoff<B>(), slack = B(20) * v * v;
    B parts(0);
    for (std::size_t i = 0; i < 3; ++i) parts = parts + abs(ways.n[i].lo) + abs(ways.f[i].lo);
    const mask_t<B> whole = parts <= B(0);
    mask_t<B> hit = B(0) <= ways.end, missed = !hit;
    const auto compare = [&](const TwoWords<B>& less, const B& m, const TwoWords<B>& more, const B& g) {
        const TwoWords<B> p = product_of(less.hi, m), q = product_of(more.hi, g), s = sum_of<B>(q.hi, -p.hi);
        const B apart = s.hi + (s.lo + ((q.lo - p.lo) + (more.lo * g - less.lo * m)));
        const B least = slack * (abs(p.hi) + abs(q.hi));
        hit = hit && ((whole && p <= q) || (!whole && apart >= least));
        missed = missed || (whole && p > q) || (!whole && apart < -least);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        hit = hit && ways.f[i].hi >= B(0);
        missed = missed || ways.f[i].hi < B(0);
        compare(ways.before_end(i), B(1), TwoWords<B>(ways.end), ways.m[i]);
        for (std::size_t j = 1; j < 3; ++j) {
            const std::size_t to = (i + j) % 3;
            compare(ways.n[i], ways.m[to], ways.f[to], ways.m[i]);
        }
    }
    const T told = number::wide::narrow<T>(select(hit, B(1), select(missed, B(-1), B(0))));
    return {told > T(0) || told<T(0), told> T(0)};
}

/// Decides exactly where the numbers fit (`fit`), by the signs of sums of words: 1 where every comparison holds, −1
/// where one fails.
template <Number T>
[[gnu::noinline]] static SlabDecision<T> exactly(const Ways<number::wide::OneWord<T>>& ways, const mask_t<T>& fit) {
    using B = number::wide::OneWord<T>;
    using number::wide::ExactSum;
    const auto yes = [](const B& x) { return select(x >= B(0), B(1), B(-1)); };
    B all = yes(ways.end);
    for (std::size_t i = 0; i < 3; ++i) {
        all = min(all, yes(ways.f[i].hi));
        ExactSum<B, 4> before_end;
        before_end.add_product(ways.end, ways.m[i]);
        before_end.add(-ways.before_end(i));
        all = min(all, yes(before_end.value()));
    }
    all = every_pair<B>(
        [&](int i, int j) {
            const auto at = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            ExactSum<B, 8> apart;
            apart.add_product(ways.f[to].hi, ways.m[at]);
            apart.add_product(ways.f[to].lo, ways.m[at]);
            apart.add_product(-ways.n[at].hi, ways.m[to]);
            apart.add_product(-ways.n[at].lo, ways.m[to]);
            return yes(apart.value());
        },
        [](const B& a, const B& b) { return min(a, b); }, all);
    return {fit, number::wide::narrow<T>(all) > T(0)};
}

}  // namespace filtered
}  // namespace lostbits::intersect::box
