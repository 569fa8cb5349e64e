// Rays and boxes: decisions in binary64, and t* in one word or two.
#pragma once

#include "measure/stages/sphere_double_double.hpp"

namespace lostbits::measure::stages {

/// How closely one word knows the t* of a box.
inline constexpr double one_word_tightness = 0x1p-48;

/// n/m with m ≥ 0, where |n̂ − n| ≤ u |n| + 1.3·2^-102 g (g = 0 where the inputs are doubles) and m is known to 2^-104.
/// ±1/0 are the ends of a slab that the ray never leaves.
template <class P>
struct Ratio {
    TwoWords<P> n, m;
    P g;
};

/// The lemma of the decisions, u = 2^-53: n₁/m₁ < n₂/m₂ where y − x > 8u (|x| + |y|) + 2^-96 (g₁ m₂ + g₂ m₁) for
/// x = n₁ m₂ and y = n₂ m₁ as binary64 computes them, since a difference, a product and the last difference lose u
/// each and the inputs' own errors 1.6·2^-102 g m. Underflow loses less than `smallest`.
template <bool two_words, class P>
mask_t<P> is_less(const Ratio<P>& a, const Ratio<P>& b, const P& scale) {
    using lostbits::abs;
    const P x = a.n.hi * b.m.hi, y = b.n.hi * a.m.hi;
    P margin = P(8 * 0x1p-53) * scale * (abs(x) + abs(y)) + P(smallest);
    if constexpr (two_words) margin = margin + P(0x1p-96) * scale * (a.g * b.m.hi + b.g * a.m.hi);
    return y - x > margin;
}

/// Entry and exit of one axis, and where the ray runs along it.
template <class P>
struct SlabInWords {
    Ratio<P> entry, exit;
    mask_t<P> sound;   ///< lo < hi for certain; where d = 0, lo < o < hi or the contrary
    mask_t<P> still;   ///< d = 0
    mask_t<P> beside;  ///< d = 0 and o outside
};

template <bool two_words, class P>
SlabInWords<P> slab_of(const ProblemInWords<P>& in, int i, const P& scale) {
    using lostbits::abs;
    const P zero(0);
    const auto minus = [&](const P& x, const P& x_low, const P& y, const P& y_low) {
        if constexpr (two_words) return TwoWords<P>{x, x_low} - TwoWords<P>{y, y_low};
        else return sum_of<P>(x, -y);
    };
    const P o = in.ray[i], d = in.ray[i + 3], lo = in.solid[i], hi = in.solid[i + 3];
    const TwoWords<P> to_lo = minus(lo, in.solid_low[i], o, in.ray_low[i]),
                      to_hi = minus(hi, in.solid_low[i + 3], o, in.ray_low[i]),
                      across = minus(hi, in.solid_low[i + 3], lo, in.solid_low[i]);
    const P g = two_words ? abs(o) + abs(lo) + abs(hi) : zero, unsure = P(0x1p-96) * scale * g;
    const auto ahead = d > zero, still = d <= zero && d >= zero;
    const auto inside = to_lo.hi < -unsure && to_hi.hi > unsure, outside = to_lo.hi > unsure || to_hi.hi < -unsure;
    const TwoWords<P> size{abs(d), two_words ? select(d < zero, -in.ray_low[i + 3], in.ray_low[i + 3]) : zero};
    const TwoWords<P> one{P(1), zero}, m = select<P>(still, {zero, zero}, size);
    return {{select<P>(still, -one, select<P>(ahead, to_lo, -to_hi)), m, g},
            {select<P>(still, one, select<P>(ahead, to_hi, -to_lo)), m, g},
            across.hi > unsure && (!still || inside || outside),
            still,
            still && outside};
}

/// The later of two entries, and whether it is known which that is. Entries behind the origin have been made 0/1.
template <bool two_words, class P>
mask_t<P> take_later(const Ratio<P>& other, const P& scale, Ratio<P>& latest) {
    const auto later = is_less<two_words>(latest, other, scale), earlier = is_less<two_words>(other, latest, scale);
    const auto neither = latest.n.hi <= P(0) && other.n.hi <= P(0);
    latest.n = select<P>(later, other.n, latest.n);
    latest.m = select<P>(later, other.m, latest.m);
    latest.g = select(later, other.g, latest.g);
    return later || earlier || neither;
}

/// As `enclose` of truth/enclose.hpp, where no two of the compared fractions are equal: then the closed box and the
/// open one agree. t = n/m of the latest entry, or 0 where every entry lies behind the origin: of doubles the sign of n
/// is that of n.hi. One word is off by 2u, or 5u with the factor |d|; two by ε = 2^-102 and what n has of the inputs.
template <bool wide, Wanted wanted, bool two_words, class P>
Finding<P> settle_box(const ProblemInWords<P>& in, const P& scale) {
    using lostbits::abs;
    using lostbits::sqrt;
    const P zero(0);
    const SlabInWords<P> slabs[3] = {slab_of<two_words>(in, 0, scale), slab_of<two_words>(in, 1, scale),
                                     slab_of<two_words>(in, 2, scale)};
    const Ratio<P> start{{zero, zero}, {P(1), zero}, zero}, end{{in.tmax, zero}, {P(1), zero}, zero};
    const auto endless = in.tmax >= P(HUGE_VAL);
    auto met = endless || in.tmax > zero, missed = zero < zero;
    auto known = met && (endless || in.tmax <= P(largest_length));
    for (int i = 0; i < 3; ++i) {
        const SlabInWords<P>& s = slabs[i];
        known = known && s.sound;
        missed = missed || s.beside || is_less<two_words>(s.exit, start, scale) ||
                 (!endless && is_less<two_words>(end, s.entry, scale));
        met = met && !s.beside && is_less<two_words>(start, s.exit, scale) &&
              (endless || is_less<two_words>(s.entry, end, scale));
        for (int j = 0; j < 3; ++j) {
            if (j == i) continue;
            missed = missed || is_less<two_words>(slabs[j].exit, s.entry, scale);
            met = met && (is_less<two_words>(s.entry, slabs[j].exit, scale) || (s.still && slabs[j].still));
        }
    }
    P lengths = zero;
    for (int k = 0; k < 6; ++k) lengths = lengths + abs(in.ray[k]) + abs(in.solid[k]);
    const auto squared = [&](int i) {
        if constexpr (two_words) return TwoWords<P>{in.ray[i], in.ray_low[i]} * TwoWords<P>{in.ray[i], in.ray_low[i]};
        else return product_of(in.ray[i], in.ray[i]);
    };
    const TwoWords<P> a = sum_of_three(squared(3), squared(4), squared(5));
    known = known && lengths <= P(largest_length) && a.hi >= P(least_length * least_length);

    Ratio<P> latest = start;
    auto told = known;
    for (const SlabInWords<P>& s : slabs) {
        const P unsure = P(0x1p-96) * scale * s.entry.g;
        const auto behind = s.entry.n.hi <= -unsure, ahead = s.entry.n.hi > unsure;
        told = told && (behind || ahead);
        const Ratio<P> entry{select<P>(ahead, s.entry.n, start.n), select<P>(ahead, s.entry.m, start.m),
                             select(ahead, s.entry.g, zero)};
        told = take_later<two_words>(entry, scale, latest) && told;
    }
    const auto at_start = latest.n.hi <= zero;
    if constexpr (!wide) {
        const P t = latest.n.hi / latest.m.hi, distance = wanted == Wanted::parameter ? zero : t * sqrt(a.hi);
        const P tightness = P(one_word_tightness) * scale, t_bound = tightness * t,
                distance_bound = tightness * distance;
        auto hit = told && met;
        if constexpr (wanted != Wanted::distance) hit = hit && (at_start || in_one_binade(t, t_bound));
        if constexpr (wanted != Wanted::parameter) hit = hit && (at_start || in_one_binade(distance, distance_bound));
        return {hit || (known && missed), hit, {{t, zero}, t_bound}, {{distance, zero}, distance_bound}};
    } else {
        const P eps = P(word_error) * scale, one(1);
        // Where t = 0 its root is not asked for; 1 in its place is a length like any other.
        const TwoWords<P> n{select(at_start, one, latest.n.hi), select(at_start, zero, latest.n.lo)};
        const TwoWords<P> t = two_words ? n / latest.m : n / latest.m.hi;
        P relative = P(4) * eps;
        if constexpr (two_words) relative = relative + P(2) * eps * latest.g / n.hi;
        const auto close = told && met && relative <= P(0x1p-72 - 0x1p-80) && in_range(n.hi) && in_range(t.hi);
        Finding<P> found = with_distance<wanted>(close, known && missed, t, relative, a, eps);
        const auto here = told && met && at_start;
        found.settled = found.settled || here;
        found.hit = found.hit || here;
        for (Enclosure<P>* const length : {&found.t, &found.distance}) {
            length->middle = select<P>(at_start, {zero, zero}, length->middle);
            length->bound = select(at_start, zero, length->bound);
        }
        return found;
    }
}

}  // namespace lostbits::measure::stages
