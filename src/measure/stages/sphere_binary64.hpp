// Binary32 rays and spheres in binary64: decisions, and t* to 2^-33 of itself.
#pragma once

#include "measure/stages/problem.hpp"

namespace lostbits::measure::stages {

/// How closely this stage and that of boxes know t*.
inline constexpr double narrow_tightness = 0x1p-33;

/// a b − c d with one rounding error of c d known (Kahan): off by at most 2u of itself (Jeannerod, Louvet and Muller,
/// "Further analysis of Kahan's algorithm for the accurate computation of 2×2 determinants", 2013).
template <class P>
P difference_of_products(const P& a, const P& b, const P& c, const P& d) {
    const P w = c * d;
    return fma(a, b, -w) + fma(-c, d, w);
}

/// The lemma, u = 2^-53. Of binary32 numbers the products of two are binary64 numbers, and nothing below under- or
/// overflows: lengths lie in [2^-149, 2^129], products of four in [2^-596, 2^520]. Where f = o − c is a binary64
/// number, too (its rounding error is computed and must be 0),
///
///     a = d·d           two sums:                                       |δa| ≤ 2u a
///     h = f·d           three products, two sums:                       |δh| ≤ 4u H,   H = Σ |f_i d_i|
///     c = f·f − r²      squares and sums with their errors, these added up in binary64 (six, together ≤ 4u(Q + R)):
///                                                                       |δc| ≤ 2u |c| + 24u² (Q + R),  Q = f·f, R = r²
///     m = f × d         Kahan:                                          |δm_i| ≤ 2u |m_i|
///     Δ = a r² − m·m    4u + u + 2u of m·m, 3u of a r², and u of both:  |δΔ| ≤ 9u (A + M) = D
///     ρ = √Δ            |√Δ̂ − √Δ| ≤ D/√Δ̂, and u:                        |δρ| ρ ≤ D + 2u Δ̂
///     s = ρ ∓ h                                                         |δs| ρ ≤ D + 2u Δ̂ + (4u H + u s) ρ = W
///
/// (first order in u; each constant leaves more than the rest takes). Outside, t = c/(ρ − h); inside, −c/(ρ + h) or,
/// where h ≤ 0, (ρ − h)/a: in lengths of the direction |δt| ≤ (|δn|/|n| + |δs|/s + 2u)|t| (1 + 2^-20), and a factor of
/// |d| = √a adds 3u. Tested as |δn| ρ s + W |n| < (2^-33 − 2^-40) |n| ρ s.
template <Wanted wanted, class P>
Finding<P> settle_sphere_binary64(const ProblemInWords<P>& in, const P& scale) {
    using lostbits::abs;
    using lostbits::sqrt;
    const P zero(0), u = P(0x1p-53) * scale;
    P f[3], left_out(0);
    for (int i = 0; i < 3; ++i) {
        const TwoWords<P> difference = sum_of<P>(in.ray[i], -in.solid[i]);
        f[i] = difference.hi;
        left_out = left_out + abs(difference.lo);
    }
    const P* const d = in.ray + 3;
    const P r = in.solid[3];
    const P a = sum_of_three<P>(d[0] * d[0], d[1] * d[1], d[2] * d[2]);
    const P hx = f[0] * d[0], hy = f[1] * d[1], hz = f[2] * d[2];
    const P h = sum_of_three(hx, hy, hz), dh = P(4) * u * sum_of_sizes(hx, hy, hz);

    const TwoWords<P> xx = product_of(f[0], f[0]), yy = product_of(f[1], f[1]), zz = product_of(f[2], f[2]);
    const P r2 = r * r;
    const TwoWords<P> xy = sum_of(xx.hi, yy.hi), q = sum_of(xy.hi, zz.hi), top = sum_of<P>(q.hi, -r2);
    const P c = top.hi + (sum_of_three(xx.lo, yy.lo, zz.lo) + sum_of_three(xy.lo, q.lo, top.lo));
    const P dc = P(2) * u * abs(c) + P(24 * 0x1p-53) * u * (q.hi + r2);

    const P mx = difference_of_products(f[1], d[2], f[2], d[1]), my = difference_of_products(f[2], d[0], f[0], d[2]),
            mz = difference_of_products(f[0], d[1], f[1], d[0]);
    const P m2 = sum_of_three<P>(mx * mx, my * my, mz * mz), ar2 = a * r2;
    const P discriminant = ar2 - m2, dd = P(9) * u * (ar2 + m2);

    const auto exact = left_out <= zero && a > zero && r > zero && a + r2 + q.hi < P(HUGE_VAL);
    const auto outside = c > dc, inside = c<-dc, through = discriminant> dd;
    const auto leaves = outside && h > dh, passes = outside && discriminant < -dd;
    const auto enters = outside && h < -dh && through, within = inside && through;

    const auto towards = h <= zero;
    const P root = sqrt(select(through, discriminant, P(1)));
    const P s = root + select(outside, -h, abs(h));
    const P w = dd + P(2) * u * discriminant + (dh + u * s) * root;
    const auto by_a = inside && towards;
    const P n = select(by_a, s, abs(c)), by = select(by_a, a, s);
    // The error of n over n is that of s where n is s, and 2u of a beside it.
    const P dn = select(by_a, P(2) * u * s, dc);
    const auto tight = dn * root * s + w * n < P(narrow_tightness - 0x1p-40) * (n * root * s);
    const P t = n / by, distance = wanted == Wanted::parameter ? zero : t * sqrt(a);
    const P t_bound = P(narrow_tightness) * t, distance_bound = P(narrow_tightness) * distance;
    auto hit = exact && (enters || within) && tight;
    if constexpr (wanted != Wanted::distance) hit = hit && in_one_binade(t, t_bound);
    if constexpr (wanted != Wanted::parameter) hit = hit && in_one_binade(distance, distance_bound);
    return {hit || (exact && (leaves || passes)), hit, {{t, zero}, t_bound}, {{distance, zero}, distance_bound}};
}

}  // namespace lostbits::measure::stages
