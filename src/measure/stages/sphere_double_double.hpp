// Rays and spheres in double-double: decisions, and t* to 2^-72 of itself.
#pragma once

#include "measure/stages/problem.hpp"

namespace lostbits::measure::stages {

/// As `truth::certified_tightness`.
inline constexpr double wide_tightness = 0x1p-72;

/// t to within `relative` of itself, and t √a: a root of a (off by 4ε) and a product add at most 4ε to it. A hit only
/// where the lengths that are wanted stay within a binade.
template <Wanted wanted, class P>
Finding<P> with_distance(mask_t<P> hit, const mask_t<P>& missed, const TwoWords<P>& t, const P& relative,
                         const TwoWords<P>& a, const P& eps) {
    const Enclosure<P> along{t, relative * t.hi};
    Enclosure<P> distance{{P(0), P(0)}, P(0)};
    if constexpr (wanted != Wanted::distance) hit = hit && in_one_binade(t, along.bound);
    if constexpr (wanted != Wanted::parameter) {
        distance.middle = t * sqrt(a);
        distance.bound = (relative + P(4) * eps) * distance.middle.hi;
        hit = hit && in_range(distance.middle.hi) && in_one_binade(distance.middle, distance.bound);
    }
    return {hit || missed, hit, along, distance};
}

/// The lemma, ε = 2^-102 (`word_error`), for lengths of at most 2^200, r ≥ 2^-200 and a = d·d ≥ 2^-400. G_i bounds what
/// f_i = o_i − c_i is made of: |f_i| where the inputs are doubles, for f_i is exact then; |o_i| + |c_i| where they are
/// known to 2^-104, with |δf_i| ≤ 1.3ε G_i. First order in ε; the constants take the larger of the two cases.
///
///     h = f·d            |δh| ≤ 5ε H,            H = Σ G_i |d_i|
///     c = f·f − r²       |δc| ≤ 7ε (Q + r²),     Q = Σ (|f_i| + ε G_i) G_i
///     m = f × d          |δm_i| ≤ 3.6ε E_i,      E_x = G_y |d_z| + G_z |d_y|, …
///     m·m                ≤ Σ (7.2ε |m_i| E_i + 13ε² E_i²) + 3.1ε m·m
///     Δ = a r² − m·m     |δΔ| ≤ D = 8ε (Σ (|m_i| + 2ε E_i) E_i + a r² + m·m)
///     ρ = √Δ             |√Δ̂ − √Δ| ≤ D/√Δ̂, and ε:   |δρ| ρ ≤ D + 2ε Δ̂
///     s = ρ ∓ h          |δs| ρ ≤ D + 2ε Δ̂ + (|δh| + 2ε s) ρ = W
///
/// with 8ε for the 5 and 7. A product that underflows loses at most 2^-1072, which ε·2^-960 in H, Q, E_i and D covers
/// (`smallest`). Outside t = c/(ρ − h); inside −c/(ρ + h), or (ρ − h)/a where h ≤ 0, and
///     |δt|/|t| ≤ (|δn| ρ s + W |n|)/(|n| ρ s) (1 + 2^-20) + 2ε,   4ε more for the distance t |d|, and for a 4ε.
/// |n| ρ s is of degree six in the lengths: it must lie within [2^-900, 2^900] as all results.
template <Wanted wanted, bool two_words, class P>
Finding<P> settle_sphere_double_double(const ProblemInWords<P>& in, const P& scale) {
    using lostbits::abs;
    const P zero(0), tiny(smallest), eps = P(word_error) * scale, eight = P(8) * eps;
    TwoWords<P> f[3], d[3], r, r2, a;
    P g[3], size[3];
    for (int i = 0; i < 3; ++i) {
        if constexpr (two_words) {
            f[i] = TwoWords<P>{in.ray[i], in.ray_low[i]} - TwoWords<P>{in.solid[i], in.solid_low[i]};
            g[i] = abs(in.ray[i]) + abs(in.solid[i]);
            d[i] = {in.ray[i + 3], in.ray_low[i + 3]};
        } else {
            f[i] = sum_of<P>(in.ray[i], -in.solid[i]);
            g[i] = abs(f[i].hi);
            d[i] = {in.ray[i + 3], zero};
        }
        size[i] = abs(d[i].hi);
    }
    const auto times = [](const TwoWords<P>& x, const TwoWords<P>& y) {
        if constexpr (two_words) return x * y;
        else return x * y.hi;
    };
    const auto squared = [](const TwoWords<P>& x) {
        if constexpr (two_words) return x * x;
        else return product_of(x.hi, x.hi);
    };
    r = {in.solid[3], two_words ? in.solid_low[3] : zero};
    r2 = squared(r);
    a = sum_of_three(squared(d[0]), squared(d[1]), squared(d[2]));

    const TwoWords<P> h = sum_of_three(times(f[0], d[0]), times(f[1], d[1]), times(f[2], d[2]));
    const P dh = eight * (sum_of_three<P>(g[0] * size[0], g[1] * size[1], g[2] * size[2]) + tiny);

    const TwoWords<P> c = sum_of_three(f[0] * f[0], f[1] * f[1], f[2] * f[2]) - r2;
    const auto of_square = [&](int i) {
        if constexpr (two_words) return (abs(f[i].hi) + eps * g[i]) * g[i];
        else return g[i] * g[i];
    };
    const P dc = eight * (sum_of_three<P>(of_square(0), of_square(1), of_square(2)) + r2.hi + tiny);

    TwoWords<P> m2;
    P of_m = tiny;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const TwoWords<P> m = times(f[j], d[k]) - times(f[k], d[j]);
        const P e = g[j] * size[k] + g[k] * size[j] + tiny;
        of_m = of_m + (abs(m.hi) + P(2) * eps * e) * e;
        m2 = i == 0 ? m * m : m2 + m * m;
    }
    const TwoWords<P> ar2 = a * r2, discriminant = ar2 - m2;
    const P dd = eight * (of_m + ar2.hi + m2.hi);

    const auto lengths =
        sum_of_three(g[0], g[1], g[2]) + sum_of_three(size[0], size[1], size[2]) + r.hi <= P(largest_length) &&
        r.hi >= P(least_length) && a.hi >= P(least_length * least_length);
    const auto outside = c.hi > dc, inside = c.hi<-dc, through = discriminant.hi> dd;
    const auto missed = (outside && h.hi > dh) || (outside && discriminant.hi < -dd);
    const auto met = through && (inside || (outside && h.hi < -dh));
    if (!any_of(lengths && met)) return {lengths && missed, zero < zero, {{zero, zero}, zero}, {{zero, zero}, zero}};

    const auto towards = h.hi <= zero;
    const TwoWords<P> root = sqrt(discriminant);
    const TwoWords<P> s = root + select<P>(outside || towards, -h, h);
    const P ws = dd + P(2) * eps * discriminant.hi + (dh + P(2) * eps * s.hi) * root.hi;
    const auto by_a = inside && towards;
    const TwoWords<P> n = select<P>(by_a, s, select<P>(outside, c, -c)), by = select<P>(by_a, a, s);
    const P dn = select(by_a, P(4) * eps, dc), in_n = select(by_a, P(1), n.hi), rs = root.hi * s.hi, nrs = in_n * rs;
    const P relative = (dn * rs + ws * in_n) / nrs * P(1 + 0x1p-20) + P(2) * eps;
    const TwoWords<P> t = n / by;
    auto hit = lengths && met && relative <= P(wide_tightness - 0x1p-80) && in_range(discriminant.hi) &&
               in_range(n.hi) && in_range(nrs) && in_range(t.hi);
    return with_distance<wanted>(hit, lengths && missed, t, relative, a, eps);
}

}  // namespace lostbits::measure::stages
