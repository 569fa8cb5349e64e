// The steps of `triangle.filtered`, and the inequalities that let a ray stop at a step.
#pragma once

#include "geometry/vec.hpp"
#include "intersect/deciding_arithmetic.hpp"
#include "number/wide/dyadic_triangle.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"
#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {
namespace filtered {

/// Result of a step for a ray: the decision and t, which are valid only if they are proved.
template <Number T>
struct TriangleDecision {
    mask_t<T> is_proved, hit;
    T t;

    /// Returns `first` where it is proved, else `second`. A type that records operations computes one ray, for which
    /// the second step was taken because the first proved nothing, so it returns `second`.
    friend TriangleDecision first_proved(const TriangleDecision& first, const TriangleDecision& second) {
        if constexpr (traces_operations<T>) return second;
        else
            return {first.is_proved || second.is_proved,
                    (first.is_proved && first.hit) || (!first.is_proved && second.hit),
                    select(first.is_proved, first.t, second.t)};
    }
};

/// Values by which `Triangle::span` decides, in any number type. a, b and c are the vertices relative to the origin, ea
/// = d·(b × c), eb = d·(c × a) and ec = d·(a × b) the tests of the edges, p = b − a, q = c − a, n = p × q, m = d·n and
/// k = a·n.
template <class N>
struct Determinants {
    Vec<N> d, a, b, c, p, q, n;
    N ea, eb, ec, m, k;
};

template <Number N>
Determinants<N> compute_determinants(const Ray<N>& ray, const Triangle<N>& triangle) {
    const Vec<N>& d = ray.direction;
    const Vec<N> a = triangle.a - ray.origin, b = triangle.b - ray.origin, c = triangle.c - ray.origin;
    const Vec<N> p = triangle.b - triangle.a, q = triangle.c - triangle.a, n = cross(p, q);
    return {.d = d,
            .a = a,
            .b = b,
            .c = c,
            .p = p,
            .q = q,
            .n = n,
            .ea = named("ea", dot(d, cross(b, c))),
            .eb = named("eb", dot(d, cross(c, a))),
            .ec = named("ec", dot(d, cross(a, b))),
            .m = named("m", dot(d, n)),
            .k = named("k", dot(a, n))};
}

/// Returns the decision by the signs of the determinants, right if these are.
template <Number N>
mask_t<N> is_hit_by_signs(const Determinants<N>& det) {
    const N zero(0), least = min(min(det.ea, det.eb), det.ec), greatest = max(max(det.ea, det.eb), det.ec);
    return (least >= zero && det.m > zero && det.k >= zero) || (greatest <= zero && det.m < zero && det.k <= zero);
}

/// Masks of the rays for which a hit or a miss is proved.
template <class P>
struct DecisionProof {
    mask_t<P> hit, miss;
};

/// Proves the decision. `det` was computed with roundoff v in each operation. Its words are of P, whose roundoff is w,
/// and t is needed in a format of roundoff u. To first order in v (Higham 2002, lemma 3.1), with M the largest of the
/// vertices' sizes:
///
///     b, c              relative error of at most v
///     d·(b × c)         each of the six products d_i b_j c_k by 7v: off by at most 7v Σ|d_i| 2M² = 14v |d| M², |d| the
///                       sum of sizes; 16v cover the terms of second order where v ≤ 2^-9
///     n_i = x − y       by 3v of x and of y, and by v of n_i
///     m, k              by v Σ|d_i| g_i and v Σ|a_i| g_i, g_i = 3(|x| + |y|) + 5|n_i|
///
/// m and k are required to have relative errors of at most s = min(14u, 2^-9). The relative error of t is then at most
/// 2s plus three roundings, within the 32u of 18 correct bits of 24. The edges add up to m, so if all have one sign, m
/// has the same.
///
/// Range, with L the least normal number of P: a number that underflows is off by wL, or by 5wL in two words. f = 64L
/// w/v covers that by v of itself. M² and |d| M² must reach f, and it is part of g_i and of the bounds of m and k. All
/// products and sums are below 64 M², 64 |d| M² or the bounds of m and k, which must be finite; comparisons with NaN
/// are false.
template <class P>
DecisionProof<P> prove_decision(const Determinants<P>& det, const P& v, const P& u) {
    const P infinity = P(1) / P(0), zero(0);
    const P f = P(64) * number::wide::smallest_normal<P>() * (unit_roundoff<P>() / v);
    const P ratio = v / min(P(14) * u, P(1) / P(512));
    const Vec<P> d = absolute_values(det.d), a = absolute_values(det.a), b = absolute_values(det.b),
                 c = absolute_values(det.c), p = absolute_values(det.p), q = absolute_values(det.q);
    const auto largest = [](const Vec<P>& x) { return max(max(x.x, x.y), x.z); };

    // The bounds of the edges, of m and of k, as above.
    const P largest_coordinate = max(max(largest(a), largest(b)), largest(c)),
            area = largest_coordinate * largest_coordinate;
    const P volume = (d.x + d.y + d.z) * area, e = P(16) * v * volume;
    const Vec<P> products(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
    const Vec<P> g = P(3) * products + P(5) * absolute_values(det.n) + Vec<P>(f, f, f);
    const P bound_m = dot(d, g) + f, bound_k = dot(a, g) + f;

    const mask_t<P> in_range = P(512) * v <= P(1) && area >= f && volume >= f && P(64) * area < infinity &&
                               P(64) * volume < infinity && bound_m < infinity && bound_k < infinity;
    const mask_t<P> is_accurate = in_range && ratio * bound_m <= abs(det.m) && ratio * bound_k <= abs(det.k);

    const mask_t<P> is_ahead = (det.m > zero && det.k > zero) || (det.m < zero && det.k < zero);
    const P least = min(min(det.ea, det.eb), det.ec), greatest = max(max(det.ea, det.eb), det.ec);
    return {is_accurate && is_ahead && (least > e || greatest < -e),
            (in_range && least < -e && greatest > e) || (is_accurate && !is_ahead)};
}

/// Returns the first word of a number: the number itself, or the high word of two.
template <class N>
N first_word(const N& x) {
    return x;
}
template <class B>
B first_word(const number::wide::TwoWords<B>& x) {
    return x.hi;
}

/// Applies `f` to every number.
template <class N, class F>
auto map_determinants(const Determinants<N>& det, const F& f) {
    using P = decltype(f(det.m));
    const auto map_vec = [&](const Vec<N>& x) { return Vec<P>(f(x.x), f(x.y), f(x.z)); };
    return Determinants<P>{.d = map_vec(det.d),
                           .a = map_vec(det.a),
                           .b = map_vec(det.b),
                           .c = map_vec(det.c),
                           .p = map_vec(det.p),
                           .q = map_vec(det.q),
                           .n = map_vec(det.n),
                           .ea = f(det.ea),
                           .eb = f(det.eb),
                           .ec = f(det.ec),
                           .m = f(det.m),
                           .k = f(det.k)};
}

/// Returns the determinants of the ray and the triangle, with `f` applied to each of their numbers first.
template <class W, Number T, class F>
Determinants<W> determinants_of_mapped(const Ray<T>& ray, const Triangle<T>& triangle, const F& f) {
    const auto map_vec = [&](const Vec<T>& x) { return Vec<W>(f(x.x), f(x.y), f(x.z)); };
    return compute_determinants<W>({map_vec(ray.origin), map_vec(ray.direction)},
                                   {map_vec(triangle.a), map_vec(triangle.b), map_vec(triangle.c)});
}

/// Returns the roundoff u of the format that `T` computes in, as a number of type P.
template <class T, class P>
P roundoff_in() {
    using number::wide::plain_value;
    using Plain = decltype(plain_value(std::declval<T>()));
    if constexpr (std::same_as<P, Plain>) return unit_roundoff<P>();
    else return number::wide::widen<P>(unit_roundoff<Plain>());
}

/// Decides in the arithmetic of W: T, its `OneWord`, or two words of that type.
template <class W, Number T>
TriangleDecision<T> decide_in(const Ray<T>& ray, const Triangle<T>& triangle) {
    using number::wide::plain_value, number::wide::constant_mask;
    const auto wide_determinants = determinants_of_mapped<W>(ray, triangle, [](const T& x) -> W {
        if constexpr (std::same_as<W, T>) return x;
        else return number::wide::widen<W>(x);
    });

    // Decides by the first word of each number, with the roundoff v of W.
    const auto det = map_determinants(wide_determinants, [](const W& x) { return first_word(x); });
    using B = std::decay_t<decltype(det.m)>;
    using P = decltype(plain_value(det.m));
    P v = unit_roundoff<P>();
    if constexpr (!std::same_as<W, B>) v = unit_roundoff<number::wide::TwoWords<P>>().hi;
    const DecisionProof<P> proof =
        prove_decision<P>(map_determinants(det, [](const B& x) { return plain_value(x); }), v, roundoff_in<T, P>());
    const mask_t<B> is_proved = constant_mask<B>(proof.hit || proof.miss);

    const B t = named("t", det.k / det.m);
    const auto hit = [&]() -> mask_t<B> {
        if constexpr (traces_operations<T>) return is_hit_by_signs<B>(det);
        else return proof.hit;
    };

    if constexpr (std::same_as<W, T>) {
        return {is_proved, hit(), t};
    } else {
        const auto narrow_mask = [](const mask_t<B>& mask) -> mask_t<T> {
            return number::wide::narrow<T>(select(mask, B(1), B(0))) > T(0);
        };
        return {narrow_mask(is_proved), narrow_mask(hit()), number::wide::narrow<T>(t)};
    }
}

/// Three numbers, each the exact sum of two words.
template <class B>
using ThreeSums = std::array<number::wide::TwoWords<B>, 3>;

/// Returns x·(y × z), the exact sum of the products of all words, rounded. The result is accurate to 2^-52 of itself,
/// and zero only if the exact value is zero. Requires that the numbers fit (`fits`).
template <class B>
B triple_product(const ThreeSums<B>& x, const ThreeSums<B>& y, const ThreeSums<B>& z) {
    using number::wide::ExactSum, number::wide::TwoWords;
    ExactSum<B, 192> all;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        ExactSum<B, 16> area;
        const auto add = [&area](const TwoWords<B>& r, const TwoWords<B>& s) {
            for (const B& word : {r.hi, r.lo}) {
                area.add_product(word, s.hi);
                area.add_product(word, s.lo);
            }
        };
        add(y[j], z[k]);
        add(-y[k], z[j]);

        for (const B& word : area.words()) {
            all.add_product(word, x[i].hi);
            all.add_product(word, x[i].lo);
        }
    }
    return all.value();
}

/// True if every number is 0 or between 2^-160 and 2^160 in size, so that products of three numbers, and of their last
/// places, are doubles. Floats always fit. Also true if a number is infinite or NaN, because wider sums would decide no
/// better.
template <Number T>
mask_t<T> fits(const Ray<T>& ray, const Triangle<T>& triangle) {
    mask_t<T> all_fit = T(0) <= T(0);
    if constexpr (number::wide::products_may_overflow<T>) {
        using B = number::wide::OneWord<T>;
        const B least = number::wide::power_of_two<B>(-160), largest = B(1) / least;
        B zero_if_finite(0);
        for (const Vec<T>* const p : {&ray.origin, &ray.direction, &triangle.a, &triangle.b, &triangle.c})
            for (int axis = 0; axis < 3; ++axis) {
                const B size = abs(number::wide::widen<B>((*p)[axis]));
                all_fit = all_fit && size <= largest && (size >= least || size <= B(0));
                zero_if_finite = zero_if_finite + B(0) * size;
            }
        all_fit = all_fit || !(zero_if_finite <= B(0));
    }
    return all_fit;
}

/// Decides by exact sums. The result is proved where the numbers fit (`fit`). The decision is narrowed to T together
/// with t, as t = −1 for a miss. m is the sum of the edge tests, accurate to 2^-50 of itself if all have one sign;
/// otherwise it is not used.
template <Number T>
[[gnu::noinline]] TriangleDecision<T> decide_by_exact_sums(const Ray<T>& ray, const Triangle<T>& triangle,
                                                           const mask_t<T>& fit) {
    using B = number::wide::OneWord<T>;
    using number::wide::sum_of, number::wide::widen, number::wide::TwoWords;
    const auto differences = [](const Vec<T>& x, const Vec<T>& base) {
        const auto difference = [](const T& r, const T& s) { return sum_of<B>(widen<B>(r), -widen<B>(s)); };
        return ThreeSums<B>{difference(x.x, base.x), difference(x.y, base.y), difference(x.z, base.z)};
    };
    const ThreeSums<B> d = differences(ray.direction, Vec<T>(T(0), T(0), T(0))),
                       a = differences(triangle.a, ray.origin), b = differences(triangle.b, ray.origin),
                       c = differences(triangle.c, ray.origin);
    const B ea = triple_product<B>(d, b, c), eb = triple_product<B>(d, c, a), ec = triple_product<B>(d, a, b);
    const B k = triple_product<B>(a, differences(triangle.b, triangle.a), differences(triangle.c, triangle.a));
    const B m = ea + eb + ec, zero(0), least = min(min(ea, eb), ec), greatest = max(max(ea, eb), ec);
    const mask_t<B> hit = (least >= zero && m > zero && k >= zero) || (greatest <= zero && m < zero && k <= zero);
    const T t = number::wide::narrow<T>(select(hit, abs(k / m), B(-1)));
    return {fit, t >= T(0), t};
}

/// Returns `known_decision`. Where it is not proved, the decision and t are computed again, over the whole range of
/// numbers.
template <Number T>
TriangleDecision<T> decide_in_every_range(const Ray<T>& ray, const Triangle<T>& triangle,
                                          const TriangleDecision<T>& known_decision) {
    const Vec<T>&o = ray.origin, &d = ray.direction, &a = triangle.a, &b = triangle.b, &c = triangle.c;
    const std::array<T, 2> answers = number::wide::apply_to_lanes<T, 15, 2>(
        select(known_decision.is_proved, T(0), T(1)),
        {o.x, o.y, o.z, d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z},
        {select(known_decision.hit, T(1), -T(1)), known_decision.t}, number::wide::meet_triangle<T>);
    return {T(0) <= T(0), answers[0] > T(0), answers[1]};
}

/// Decides without rounding where `known_decision` is not proved.
template <Number T>
TriangleDecision<T> decide_exactly(const Ray<T>& ray, const Triangle<T>& triangle, TriangleDecision<T> known_decision) {
    const mask_t<T> fit = fits(ray, triangle);
    if (any_of(!known_decision.is_proved && fit))
        known_decision = first_proved(known_decision, decide_by_exact_sums<T>(ray, triangle, fit));
    if constexpr (number::wide::products_may_overflow<T>)
        if (any_of(!known_decision.is_proved)) return decide_in_every_range<T>(ray, triangle, known_decision);
    return known_decision;
}

/// Does what `decide_exactly` does, for number types that record operations. They have no operation for exact sums, so
/// the step is recorded as a call.
template <Number T>
TriangleDecision<T> decide_in_a_call(const Ray<T>& ray, const Triangle<T>& triangle) {
    using number::wide::plain_value, number::wide::record_call;
    using P = decltype(plain_value(ray.origin.x));
    const P zero(0);
    const TriangleDecision<P> decision = decide_exactly<P>(
        {plain_value(ray.origin), plain_value(ray.direction)},
        {plain_value(triangle.a), plain_value(triangle.b), plain_value(triangle.c)}, {zero < zero, zero < zero, zero});
    const Vec<T>&o = ray.origin, &d = ray.direction, &a = triangle.a, &b = triangle.b, &c = triangle.c;
    const std::array<T, 15> inputs{o.x, o.y, o.z, d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
    const T decision_call =
        record_call<T>({"triangle.filtered", CallAnswer::decision}, inputs, select(decision.hit, P(1), P(-1)));
    return {number::wide::constant_mask<T>(decision.is_proved), decision_call > T(0),
            record_call<T>({"triangle.filtered", CallAnswer::t}, inputs, decision.t)};
}

/// Decides where `first_decision` is not proved: in double-double, then without rounding.
template <Number T, class Watch>
TriangleDecision<T> decide_further(const Ray<T>& ray, const Triangle<T>& triangle,
                                   const TriangleDecision<T>& first_decision, Watch& watch) {
    watch(DecidingArithmetic::two_words);
    const auto in_two_words = [&] {
        const Part<T> part("in two words");
        return first_proved(first_decision, decide_in<number::wide::TwoWords<number::wide::OneWord<T>>>(ray, triangle));
    };
    const TriangleDecision<T> two_word_decision = in_two_words();
    if (!any_of(!two_word_decision.is_proved)) return two_word_decision;
    watch(DecidingArithmetic::exact);
    if constexpr (traces_operations<T>) return decide_in_a_call<T>(ray, triangle);
    else return decide_exactly<T>(ray, triangle, two_word_decision);
}

/// Does what `decide_further` does, as a function of its own that takes its arguments by value, so that the loops over
/// packs keep their registers.
template <Number T, class Watch>
[[gnu::noinline]] TriangleDecision<T> finish(Ray<T> ray, Triangle<T> triangle, TriangleDecision<T> first_decision,
                                             Watch& watch) {
    return decide_further<T>(ray, triangle, first_decision, watch);
}
template <Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] TriangleDecision<T> finish(Ray<T> ray, Triangle<T> triangle,
                                                           TriangleDecision<T> first_decision, Watch& watch) {
    return decide_further<T>(ray, triangle, first_decision, watch);
}

}  // namespace filtered
}  // namespace lostbits::intersect::triangle
