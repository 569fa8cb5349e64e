// The steps of `sphere.filtered`, and the inequalities that let a ray stop at a step.
#pragma once

#include "geometry/vec.hpp"
#include "intersect/filter/last_steps.hpp"
#include "intersect/roots.hpp"
#include "number/wide/dyadic_sphere.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"

namespace lostbits::intersect::sphere {
namespace filtered {

using filter::Decision;

/// Values that `decide_cheaply` computes.
template <Number T>
struct CheapValues {
    Vec<T> f;
    T r, inv, s, delta, root;
};

/// Proves the decision of `decide_cheaply` from bounds on its values; `decide_cheaply` derives them.
template <Number T>
Decision<T> prove_cheap_decision(const CheapValues<T>& values, const T& t) {
    using number::wide::plain_value;
    using P = decltype(plain_value(t));
    const P u = unit_roundoff<P>(), infinity = P(1) / P(0), r = plain_value(values.r), s = plain_value(values.s),
            root = plain_value(values.root);
    const P inv = plain_value(values.inv), delta = plain_value(values.delta);
    const Vec<P> f = plain_value(values.f);
    const P ff = square(f), w = (P(21) / P(10) * u) * (abs(f.x) + abs(f.y) + abs(f.z)) + P(4) * u * r;
    const P e = w * (P(2) * r + P(32) * w);
    // In coarser formats no distance is large enough.
    const P min_ratio = select(P(1024) * u <= P(1), P(2), infinity);
    const P least = number::wide::root_of_smallest_normal<P>() / (P(23) * u);
    const P most = P(1) / (P(64) * number::wide::smallest_normal<P>());
    const mask_t<P> in_range = ff >= max(least, min_ratio * square(r)) && inv >= least && max(ff, inv) <= most;
    // The last comparison fails where s ≤ 0, so a hit is ahead.
    const mask_t<P> is_hit = delta > P(4) * e && e * inv < root * (P(36) * u * s - P(66) * u * root);
    const mask_t<P> is_miss = s <= P(0) || delta < -e;
    const mask_t<T> is_proved = number::wide::constant_mask<T>(in_range && (is_hit || is_miss));
    if constexpr (traces_operations<T>) return {is_proved, values.delta > T(0) && values.s > T(0), t};
    else return {is_proved, is_hit, t};
}

/// Decides a ray from outside, |f| ≥ √2 r, in T alone. With f = o − G, G the centre, and a = d·d: s = −f·d/a, l = f + s
/// d, Δ = r² − l·l, t = s − √(Δ/a). It takes one division and one root.
///
/// u is T's unit roundoff, at most 2^-10; φ = u|f|, F = |f|/|d|, and hats mark computed values. The last digits of the
/// constants cover terms of second order. (Higham 2002, lemma 3.1 and section 3.3, in norms.)
///
///     f, f·d, a        |δf_i| ≤ u|f_i|,   |δ(f·d)| ≤ 4.1u|f||d|,   |δa| ≤ 3.05u a
///     s                |δs| ≤ 4.2u F + 5.2u|s| ≤ 9.5u F
///     f + s d          |f + (s + δs)d|² = |l|² + a δs² ≤ |l|² + 91φ²: the error of s moves l along d, so it counts
///                      only squared
///     l̂                off from f + (s + δs)d by 2.05φ + u|l̂| (f, the product, the sum); its square rounds three
///                      times:   | |l̂| − |f + (s + δs)d| | ≤ δ + 2.6u|l̂|,  δ = 2.05φ
///
/// With w = 2.1u(|f_x| + |f_y| + |f_z|) + 4ur and E = w(2r + 32w), Δ̂ > E implies |l| < r, and Δ̂ < −E implies |l| > r:
/// from |l̂|² > r² + E follows (1 − 2.6u)|l̂| > δ + √(r² + 91φ²), because the square of the right side is at most
/// r² + 4.1φr + 134φ², times 1 + 5.5u. For hits, |Δ̂ − Δ| ≤ E.
///
/// Ahead or behind: where Δ̂ ≥ −E, s²a = f·f − l·l ≥ f·f − r² − 2E ≥ 0.47 f·f, so |s| ≥ 0.68F > |δs|, and the sign of s
/// is right. Where Δ̂ < −E, the sign does not matter.
///
/// t: from Δ̂ > 4E follows |√Δ̂ − √Δ| ≤ E/(√Δ̂ + √(Δ̂ − E)) ≤ E/(1.866√Δ̂). F ≤ 1.42s, and the root rounds by 3.6u
/// more. So
///     |δt| ≤ 11.2u s + 3.6u root + E/(a·1.866·root) + u t,
/// which is at most 32u t, 18 correct bits of 24, where E/a ≤ u root (36s − 66root), with t = s − root.
///
/// Range, with L the least normal number: a product that underflows is off by uL more. Where f·f and 1/a are both
/// between √L/(23u) and 1/(64L), nothing overflows, and |f||d| and F are at least 64L. Then f·d, s, f + s d and w lose
/// a 64th of their bounds. |l|², r² and e lose 5uL ≤ 1.25φ². E contains 141φ² and needs only 134φ², so it covers this
/// loss. Where Δ̂ > 4E, Δ̂/a ≥ 4·141u²F² > L is normal. The test of a hit is strict, because both of its sides may
/// overflow.
template <Number T>
Decision<T> decide_cheaply(const Ray<T>& ray, const Sphere<T>& sphere) {
    const T r2 = square(sphere.radius);
    const Vec<T> f = sphere.centre - ray.origin;  // −f of the derivation, so that s and l need no minus
    const T inv = named("inv", T(1) / square(ray.direction));
    const T s = named("s", dot(f, ray.direction) * inv);
    const Vec<T> l = f - s * ray.direction;
    const T delta = named("delta", r2 - square(l));
    const T root = named("root", sqrt(delta * inv));
    return prove_cheap_decision<T>({f, sphere.radius, inv, s, delta, root}, named("t", s - root));
}

/// Values that `decide_in_wider` computes.
template <Number T>
struct WideValues {
    T r, a, h, c, disc, root, q;
};

/// Proves the decision of `decide_in_wider` from bounds on its values; `decide_in_wider` derives them. W is the wider
/// number type.
template <class W, Number T>
Decision<T> prove_wide_decision(const WideValues<T>& values, const T& t) {
    using number::wide::plain_value;
    using P = decltype(plain_value(t));
    const P u = unit_roundoff<P>(), least = number::wide::smallest_normal<P>(), infinity = P(1) / P(0);
    const P a = plain_value(values.a), h = plain_value(values.h), c = plain_value(values.c),
            disc = plain_value(values.disc), q = plain_value(values.q);
    const P r2 = square(plain_value(values.r)), sum = (c + r2) + r2;
    const P v = max(plain_value(number::wide::narrow<T>(unit_roundoff<W>())), P(2) * u * least);
    const P e = (P(6) * v) * (P(4) * sum * a) + P(64) * least;
    const P min_value = select(number::wide::has_smaller_normals<P>(), P(64) * least, least / v);
    const mask_t<P> is_accurate = P(32) * u <= P(1) && P(2) * v <= u && min(abs(c), a) >= min_value && e < infinity &&
                                  abs(h) < infinity && !(q >= infinity) && abs(c) >= sum * (v / u);
    const mask_t<P> is_miss = c > P(0) && (h > P(0) || disc < -e);
    const mask_t<P> is_hit = !is_miss && disc > e && e <= plain_value(values.root) * (q * (P(16) * u));
    const mask_t<T> is_proved = number::wide::constant_mask<T>(is_accurate && (is_hit || is_miss));
    if constexpr (traces_operations<T>)
        return {is_proved, !(values.c > T(0) && values.h > T(0)) && values.disc > T(0), t};
    else return {is_proved, is_hit, t};
}

/// Decides a ray from anywhere. h = f·d, c = f·f − r² and D = h² − ac are computed in W, and the rest in T: t = c/q or
/// q/a with q = |h| + √D. No root and no quotient is computed in W.
///
/// v is W's unit roundoff; u is T's, at most 1/32. In W, with A = f·f + r² and to first order in v,
///     |δh| ≤ 4v|f||d|,  |δc| ≤ 5v A + v|c|,  |δa| ≤ 3v a,  |δD| ≤ v a (19 f·f + 6r²) + v|D|,
/// so the sign of D is right where |D| > e = 24 v A a. A quarter of e is not needed for this, and covers the rounding
/// of e itself in T.
///
/// c has a relative error of at most 6u, and the right sign, where |c| ≥ (v/u) A, which is part of `is_accurate`. If D
/// ≥ 0 there, h² ≥ a|c| from outside, so |h| ≥ √(v/u) |f||d|, which is more than |δh|: the sign of h is right wherever
/// it matters. q² ≥ a|c| everywhere, so the error of h is at most 4√(uv) q. (f·f is at most A.)
///
/// t: D contributes |√D̂ − √D|/q ≤ e/(√D̂ q), which is required to be at most 16u. The rest is 6u of c, and the
/// roundings of h, c, D, √, +, ÷ in T: 27u together, within the 32u of 18 correct bits of 24.
///
/// Range, with L the least normal number of T: a product in T, and a number narrowed to T, is off by up to uL more,
/// which 64L in e cover. Where |c| and a are at least 64L, so is q, and so is |h| where D ≥ 0 outside, so they are
/// normal. W has T's range if T has no wider word. Then |c| and a are at least L/v, so that the loss of products, 4uL
/// each, is uv of A, of a and of √(Aa). Overflow: e < ∞ implies |c| < ∞, a < ∞ and h², ac ≤ A a < ∞/4, and |h| and q
/// are tested. Comparisons with a number that overflowed on the way are false.
template <class W, Number T>
Decision<T> decide_in_wider(const Ray<T>& ray, const Sphere<T>& sphere) {
    using number::wide::narrow, number::wide::widen;
    const auto widen_vec = [](const Vec<T>& x) { return Vec<W>(widen<W>(x.x), widen<W>(x.y), widen<W>(x.z)); };
    const Vec<W> d = widen_vec(ray.direction), f = widen_vec(ray.origin) - widen_vec(sphere.centre);
    const W aw = square(d), hw = dot(f, d), cw = square(f) - square(widen<W>(sphere.radius));
    const W dw = square(hw) - aw * cw;

    const T a = named("a", narrow<T>(aw)), h = named("h", narrow<T>(hw)), c = named("c", narrow<T>(cw));
    const T disc = named("D", narrow<T>(dw));
    const T root = named("root", sqrt(disc)), q = named("q", abs(h) + root);
    const mask_t<T> is_outside = c > T(0), is_behind = h > T(0), is_inside = !(is_outside || is_behind);
    const T t = named("t", select(is_inside, q, abs(c)) / select(is_inside, a, q));
    return prove_wide_decision<W, T>({sphere.radius, a, h, c, disc, root, q}, t);
}

/// The terms h, c, a and D = a r² − |f × d|², each an exact sum of products of the words of f = o − G and of d,
/// rounded. Each is accurate to 2^-52 of itself, and zero only if the exact value is zero. Requires that the numbers
/// fit (`filter::fits`).
template <Number B>
struct ExactTerms {
    B h, c, a, disc;

    ExactTerms(const Ray<B>& ray, const Sphere<B>& sphere) : h(0), c(0), a(0), disc(0) {
        using number::wide::ExactSum, number::wide::sum_of, number::wide::TwoWords;
        const Vec<B>& d = ray.direction;
        const TwoWords<B> f[3] = {sum_of<B>(ray.origin.x, -sphere.centre.x), sum_of<B>(ray.origin.y, -sphere.centre.y),
                                  sum_of<B>(ray.origin.z, -sphere.centre.z)};
        const TwoWords<B> r2 = number::wide::product_of(sphere.radius, sphere.radius);
        ExactSum<B, 12> h_sum;
        ExactSum<B, 20> c_sum;
        ExactSum<B, 6> a_sum;
        ExactSum<B, 240> disc_sum;
        for (int i = 0; i < 3; ++i) {
            // h += f_i d_i, c += f_i², a += d_i²
            h_sum.add_product(f[i].hi, d[i]);
            h_sum.add_product(f[i].lo, d[i]);
            c_sum.add_product(f[i].hi, f[i].hi);
            c_sum.add_product(f[i].hi + f[i].hi, f[i].lo);
            c_sum.add_product(f[i].lo, f[i].lo);
            a_sum.add_product(d[i], d[i]);

            // m = component i of f × d
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            ExactSum<B, 8> m;
            m.add_product(f[j].hi, d[k]);
            m.add_product(f[j].lo, d[k]);
            m.add_product(-f[k].hi, d[j]);
            m.add_product(-f[k].lo, d[j]);

            // D −= m², by the products of all pairs of words
            for (std::size_t x = 0; x < m.words().size(); ++x) {
                const B& word = m.words()[x];
                disc_sum.add_product(-word, word);
                for (const B& other : m.words().subspan(x + 1)) disc_sum.add_product(word + word, -other);
            }
        }

        // c −= r², D += a r²
        c_sum.add(-r2);
        for (const B& word : a_sum.words()) {
            disc_sum.add_product(word, r2.hi);
            disc_sum.add_product(word, r2.lo);
        }

        h = h_sum.value();
        c = c_sum.value();
        a = a_sum.value();
        disc = disc_sum.value();
    }
};

/// Returns the decision and t from the terms, without a bound: the terms have the right signs, or T is exact. A ray
/// that touches hits, and a ray that starts on the surface hits at t = 0.
template <Number T>
Decision<T> decide_from_terms(const T& h, const T& c, const T& a, const T& disc) {
    const T root = named("root", sqrt(disc)), q = named("q", abs(h) + root);
    const T t = decide(c < T(0) && h <= T(0), [&](const mask_t<T>& is_inside) {
        return T(select(is_inside, q, abs(c)) / select(is_inside, a, q));
    });
    const mask_t<T> on_surface = c >= T(0) && c <= T(0);
    return {T(0) <= T(0), !(c > T(0)) || (disc >= T(0) && h < T(0)), select(on_surface, T(0), t)};
}

/// Decides in exact arithmetic, which needs no filter.
template <Number T>
Decision<T> decide_unrounded(const Ray<T>& ray, const Sphere<T>& sphere) {
    const Vec<T> f = ray.origin - sphere.centre;
    const T a = named("a", square(ray.direction)), h = named("h", dot(f, ray.direction));
    const T r2 = square(sphere.radius), c = named("c", square(f) - r2);
    return decide_from_terms<T>(h, c, a, named("D", a * r2 - square(cross(f, ray.direction))));
}

/// Decides by exact sums. The result is proved where the numbers fit (`fit`). The decision is narrowed to T together
/// with t, as t = −1 for a miss, because T may be narrower and have other masks.
template <Number T>
[[gnu::noinline]] Decision<T> decide_by_exact_sums(const Ray<T>& ray, const Sphere<T>& sphere, const mask_t<T>& fit) {
    using B = number::wide::OneWord<T>;
    const auto widen = [](const T& x) { return number::wide::widen<B>(x); };
    const auto widen_vec = [&](const Vec<T>& x) { return Vec<B>(widen(x.x), widen(x.y), widen(x.z)); };
    const ExactTerms<B> terms(Ray<B>{widen_vec(ray.origin), widen_vec(ray.direction)},
                              Sphere<B>{widen_vec(sphere.centre), widen(sphere.radius)});
    const Decision<B> decision = decide_from_terms<B>(terms.h, terms.c, terms.a, terms.disc);
    const T t = number::wide::narrow<T>(select(decision.hit, decision.t, B(-1)));
    return {fit, t >= T(0), t};
}

/// The form's own formulas for the last steps (intersect/filter/last_steps.hpp).
struct SphereSteps {
    static constexpr std::string_view name = "sphere.filtered";
    template <class T>
    static void in_any_range(const auto& numbers, auto& answer) {
        number::wide::meet_sphere<T>(numbers, answer);
    }

    template <Number T>
    static Decision<T> in_two_words(const Ray<T>& ray, const Sphere<T>& sphere) {
        return decide_in_wider<number::wide::TwoWords<number::wide::OneWord<T>>, T>(ray, sphere);
    }
    template <Number T>
    static Decision<T> by_exact_sums(const Ray<T>& ray, const Sphere<T>& sphere, const mask_t<T>& fit) {
        return decide_by_exact_sums<T>(ray, sphere, fit);
    }
};

}  // namespace filtered
}  // namespace lostbits::intersect::sphere
