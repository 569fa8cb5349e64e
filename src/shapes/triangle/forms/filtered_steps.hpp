// The steps of `triangle.filtered`, and the inequalities that let a ray stop at a step.
#pragma once

#include "geometry/vec.hpp"
#include "intersect/filter_arithmetic.hpp"
#include "number/wide/dyadic_triangle.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"
#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {
namespace filtered {

/// The result of a step for a ray: the decision and t if they are proved, else nothing.
template <Number T>
struct TriangleDecision {
    mask_t<T> proved, hit;
    T t;

    /// Returns `first` where it is proved, else `second`. A number that records operations belongs to one ray, which
    /// needed the second step because the first one proved nothing.
    friend TriangleDecision joined(const TriangleDecision& first, const TriangleDecision& second) {
        if constexpr (traces_operations<T>) return second;
        else
            return {first.proved || second.proved, (first.proved && first.hit) || (!first.proved && second.hit),
                    select(first.proved, first.t, second.t)};
    }
};

/// The values that decide in `Triangle::span`, in any number type: the edges, with the vertices relative to the
/// origin, m = d·n and k = a·n with n = p × q, p = b − a and q = c − a.
template <class N>
struct Determinants {
    Vec<N> d, a, b, c, p, q, n;
    N ea, eb, ec, m, k;
};

template <Number N>
Determinants<N> determinants_of(const Ray<N>& ray, const Triangle<N>& triangle) {
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

/// The decision by the signs, if they are right.
template <Number N>
mask_t<N> meets(const Determinants<N>& of) {
    const N zero(0), least = min(min(of.ea, of.eb), of.ec), most = max(max(of.ea, of.eb), of.ec);
    return (least >= zero && of.m > zero && of.k >= zero) || (most <= zero && of.m < zero && of.k <= zero);
}

/// Masks of the rays whose hit or miss is proved.
template <class P>
struct Proved {
    mask_t<P> met, missed;
};

/// Proves the decision. `of` was computed with v the roundoff of an operation. Its words are of P, whose roundoff is w,
/// and t is needed in a format of roundoff u. To first order in v (Higham 2002, lemma 3.1), with M the largest of the
/// vertices' sizes:
///
///     b, c              off by v of themselves
///     d·(b × c)         each of the six products d_i b_j c_k by 7v: off by at most 7v Σ|d_i| 2M² = 14v |d| M², |d| the
///                       sum of sizes; 16v cover the terms of second order where v ≤ 2^-9
///     n_i = x − y       by 3v of x and of y, and by v of n_i
///     m, k              by v Σ|d_i| g_i and v Σ|a_i| g_i, g_i = 3(|x| + |y|) + 5|n_i|
///
/// m and k are required to be right to s = min(14u, 2^-9) of themselves. t is then right to 2s and three roundings,
/// within the 32u of 18 correct bits of 24. The edges add up to m, so if all have one sign, m has the same.
///
/// Range, with L the least normal number of P: a number that underflows is off by wL, or by 5wL in two words. f = 64L
/// w/v covers that by v of itself. M² and |d| M² must reach f, and it is part of g_i and of the bounds of m and k. All
/// products and sums are below 64 M², 64 |d| M² or the bounds of m and k, which must be finite; comparisons with NaN
/// are false.
template <class P>
Proved<P> proved_by(const Determinants<P>& of, const P& v, const P& u) {
    const P none = P(1) / P(0), zero(0);
    const P f = P(64) * number::wide::least_normal<P>() * (unit_roundoff<P>() / v);
    const P ratio = v / min(P(14) * u, P(1) / P(512));
    const Vec<P> d = sizes(of.d), a = sizes(of.a), b = sizes(of.b), c = sizes(of.c), p = sizes(of.p), q = sizes(of.q);
    const auto largest = [](const Vec<P>& x) { return max(max(x.x, x.y), x.z); };
    const P most_way = max(max(largest(a), largest(b)), largest(c)), area = most_way * most_way;
    const P volume = (d.x + d.y + d.z) * area, e = P(16) * v * volume;
    const Vec<P> products(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
    const Vec<P> g = P(3) * products + P(5) * sizes(of.n) + Vec<P>(f, f, f);
    const P of_m = dot(d, g) + f, of_k = dot(a, g) + f;
    const mask_t<P> in_range = P(512) * v <= P(1) && area >= f && volume >= f && P(64) * area < none &&
                               P(64) * volume < none && of_m < none && of_k < none;
    const mask_t<P> good = in_range && ratio * of_m <= abs(of.m) && ratio * of_k <= abs(of.k);
    const mask_t<P> ahead = (of.m > zero && of.k > zero) || (of.m < zero && of.k < zero);
    const P least = min(min(of.ea, of.eb), of.ec), most = max(max(of.ea, of.eb), of.ec);
    return {good && ahead && (least > e || most < -e), (in_range && least < -e && most > e) || (good && !ahead)};
}

/// The first word of a number: the number itself, or the high word of two.
template <class N>
N word_of(const N& x) {
    return x;
}
template <class B>
B word_of(const number::wide::TwoWords<B>& x) {
    return x.hi;
}

/// Applies `f` to every number.
template <class N, class F>
auto each_of(const Determinants<N>& of, const F& f) {
    using P = decltype(f(of.m));
    const auto v = [&](const Vec<N>& x) { return Vec<P>(f(x.x), f(x.y), f(x.z)); };
    return Determinants<P>{.d = v(of.d),
                           .a = v(of.a),
                           .b = v(of.b),
                           .c = v(of.c),
                           .p = v(of.p),
                           .q = v(of.q),
                           .n = v(of.n),
                           .ea = f(of.ea),
                           .eb = f(of.eb),
                           .ec = f(of.ec),
                           .m = f(of.m),
                           .k = f(of.k)};
}

/// The determinants of the ray and the triangle, with `f` applied to every number.
template <class W, Number T, class F>
Determinants<W> determinants_in(const Ray<T>& ray, const Triangle<T>& triangle, const F& f) {
    const auto v = [&](const Vec<T>& x) { return Vec<W>(f(x.x), f(x.y), f(x.z)); };
    return determinants_of<W>({v(ray.origin), v(ray.direction)}, {v(triangle.a), v(triangle.b), v(triangle.c)});
}

/// The roundoff u of the format that `T` computes in, as a number of P.
template <class T, class P>
P roundoff_in() {
    using number::wide::value_of;
    using Plain = decltype(value_of(std::declval<T>()));
    if constexpr (std::same_as<P, Plain>) return unit_roundoff<P>();
    else return number::wide::widen<P>(unit_roundoff<Plain>());
}

/// Decides in W: T, its `OneWord`, or two of those.
template <class W, Number T>
TriangleDecision<T> settled_in(const Ray<T>& ray, const Triangle<T>& triangle) {
    using number::wide::value_of, number::wide::constant_mask;
    const auto in = determinants_in<W>(ray, triangle, [](const T& x) -> W {
        if constexpr (std::same_as<W, T>) return x;
        else return number::wide::widen<W>(x);
    });
    const auto of = each_of(in, [](const W& x) { return word_of(x); });
    using B = std::decay_t<decltype(of.m)>;
    using P = decltype(value_of(of.m));
    P v = unit_roundoff<P>();
    if constexpr (!std::same_as<W, B>) v = unit_roundoff<number::wide::TwoWords<P>>().hi;
    const Proved<P> by = proved_by<P>(each_of(of, [](const B& x) { return value_of(x); }), v, roundoff_in<T, P>());
    const mask_t<B> proved = constant_mask<B>(by.met || by.missed);
    const B t = named("t", of.k / of.m);
    const auto hit = [&]() -> mask_t<B> {
        if constexpr (traces_operations<T>) return meets<B>(of);
        else return by.met;
    };
    if constexpr (std::same_as<W, T>) {
        return {proved, hit(), t};
    } else {
        const auto told = [](const mask_t<B>& mask) -> mask_t<T> {
            return number::wide::narrow<T>(select(mask, B(1), B(0))) > T(0);
        };
        return {told(proved), told(hit()), number::wide::narrow<T>(t)};
    }
}

/// Three differences or numbers, each the exact sum of two words.
template <class B>
using ThreeSums = std::array<number::wide::TwoWords<B>, 3>;

/// x·(y × z), accurate to 2^-52 of itself, and zero only if the exact value is: the sum of the products of all words.
/// It is exact while the numbers fit.
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

/// True if every number is 0 or between 2^-160 and 2^160 in size, so that products of three, and those of their last
/// places, are doubles. Floats always fit. Also true if a number is infinite or NaN,
/// because wider sums would decide no better.
template <Number T>
mask_t<T> fits(const Ray<T>& ray, const Triangle<T>& triangle) {
    mask_t<T> all = T(0) <= T(0);
    if constexpr (number::wide::has_whole_range<T>) {
        using B = number::wide::OneWord<T>;
        const B least = number::wide::power_of_two<B>(-160), most = B(1) / least;
        B none(0);
        for (const Vec<T>* const p : {&ray.origin, &ray.direction, &triangle.a, &triangle.b, &triangle.c})
            for (int axis = 0; axis < 3; ++axis) {
                const B size = abs(number::wide::widen<B>((*p)[axis]));
                all = all && size <= most && (size >= least || size <= B(0));
                none = none + B(0) * size;
            }
        all = all || !(none <= B(0));
    }
    return all;
}

/// Decides exactly, and is proved where the numbers fit (`fit`). The answer is narrowed as t, with −1 for a miss. The
/// edges add up to m, to 2^-50 of itself if all have one sign; otherwise m is not used.
template <Number T>
[[gnu::noinline]] TriangleDecision<T> exactly(const Ray<T>& ray, const Triangle<T>& triangle, const mask_t<T>& fit) {
    using B = number::wide::OneWord<T>;
    using number::wide::sum_of, number::wide::widen, number::wide::TwoWords;
    const auto apart = [](const Vec<T>& x, const Vec<T>& from) {
        const auto one = [](const T& r, const T& s) { return sum_of<B>(widen<B>(r), -widen<B>(s)); };
        return ThreeSums<B>{one(x.x, from.x), one(x.y, from.y), one(x.z, from.z)};
    };
    const ThreeSums<B> d = apart(ray.direction, Vec<T>(T(0), T(0), T(0))), a = apart(triangle.a, ray.origin),
                       b = apart(triangle.b, ray.origin), c = apart(triangle.c, ray.origin);
    const B ea = triple_product<B>(d, b, c), eb = triple_product<B>(d, c, a), ec = triple_product<B>(d, a, b);
    const B k = triple_product<B>(a, apart(triangle.b, triangle.a), apart(triangle.c, triangle.a));
    const B m = ea + eb + ec, zero(0), least = min(min(ea, eb), ec), most = max(max(ea, eb), ec);
    const mask_t<B> hit = (least >= zero && m > zero && k >= zero) || (most <= zero && m < zero && k <= zero);
    const T t = number::wide::narrow<T>(select(hit, abs(k / m), B(-1)));
    return {fit, t >= T(0), t};
}

/// Returns `known`; where it proves nothing, the decision and t are computed over the whole range.
template <Number T>
TriangleDecision<T> in_every_range(const Ray<T>& ray, const Triangle<T>& triangle, const TriangleDecision<T>& known) {
    const Vec<T>&o = ray.origin, &d = ray.direction, &a = triangle.a, &b = triangle.b, &c = triangle.c;
    const std::array<T, 2> all = number::wide::masked_lanes<T, 15, 2>(
        select(known.proved, T(0), T(1)), {o.x, o.y, o.z, d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z},
        {select(known.hit, T(1), -T(1)), known.t}, number::wide::meet_triangle<T>);
    return {T(0) <= T(0), all[0] > T(0), all[1]};
}

/// Decides without rounding what `known` leaves open.
template <Number T>
TriangleDecision<T> to_the_last_digit(const Ray<T>& ray, const Triangle<T>& triangle, TriangleDecision<T> known) {
    const mask_t<T> fit = fits(ray, triangle);
    if (any_of(!known.proved && fit)) known = joined(known, exactly<T>(ray, triangle, fit));
    if constexpr (number::wide::has_whole_range<T>)
        if (any_of(!known.proved)) return in_every_range<T>(ray, triangle, known);
    return known;
}

/// The same for number types that record operations. They have no operation for it, so it is recorded as a call.
template <Number T>
TriangleDecision<T> in_a_call(const Ray<T>& ray, const Triangle<T>& triangle) {
    using number::wide::value_of, number::wide::record_call;
    using P = decltype(value_of(ray.origin.x));
    const P none(0);
    const TriangleDecision<P> found = to_the_last_digit<P>(
        {value_of(ray.origin), value_of(ray.direction)},
        {value_of(triangle.a), value_of(triangle.b), value_of(triangle.c)}, {none < none, none < none, none});
    const Vec<T>&o = ray.origin, &d = ray.direction, &a = triangle.a, &b = triangle.b, &c = triangle.c;
    const std::array<T, 15> of{o.x, o.y, o.z, d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
    const T decision = record_call<T>({"triangle.filtered", CallAnswer::decision}, of, select(found.hit, P(1), P(-1)));
    return {number::wide::constant_mask<T>(found.proved), decision > T(0),
            record_call<T>({"triangle.filtered", CallAnswer::t}, of, found.t)};
}

/// Decides what `soft` leaves open: in double-double, then without rounding.
template <Number T, class Watch>
TriangleDecision<T> beyond(const Ray<T>& ray, const Triangle<T>& triangle, const TriangleDecision<T>& soft,
                           Watch& watch) {
    watch(FilterArithmetic::two_words);
    const auto in_two_words = [&] {
        const Part<T> part("in two words");
        return joined(soft, settled_in<number::wide::TwoWords<number::wide::OneWord<T>>>(ray, triangle));
    };
    const TriangleDecision<T> wide = in_two_words();
    if (!any_of(!wide.proved)) return wide;
    watch(FilterArithmetic::exact);
    if constexpr (traces_operations<T>) return in_a_call<T>(ray, triangle);
    else return to_the_last_digit<T>(ray, triangle, wide);
}

/// The same as a function of its own that takes its arguments by value, so that the loops over packs keep their
/// registers.
template <Number T, class Watch>
[[gnu::noinline]] TriangleDecision<T> to_the_end(Ray<T> ray, Triangle<T> triangle, TriangleDecision<T> soft,
                                                 Watch& watch) {
    return beyond<T>(ray, triangle, soft, watch);
}
template <Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] TriangleDecision<T> to_the_end(Ray<T> ray, Triangle<T> triangle,
                                                               TriangleDecision<T> soft, Watch& watch) {
    return beyond<T>(ray, triangle, soft, watch);
}

}  // namespace filtered
}  // namespace lostbits::intersect::triangle
