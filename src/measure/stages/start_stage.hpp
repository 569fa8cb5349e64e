// Settles rays that begin near or on a surface of degree four, many at once. There the first crossing lies so near to
// the origin that the sums of `span` lose it; the polynomial along the ray, counted from the origin, keeps it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "geometry/first_root.hpp"
#include "measure/stages/span_stages.hpp"
#include "measure/stages/tie_stage.hpp"
#include "number/wide/dyadic.hpp"

namespace lostbits::measure::stages {

/// Selects shapes with a polynomial of degree four along a ray (`along`) and the usual convention.
template <class S>
inline constexpr bool is_quartic_along = false;
template <template <class> class Of, class E>
requires requires(const Of<E>& shape, const Ray<E>& ray) { shape.along(ray); }
inline constexpr bool is_quartic_along<Of<E>> = true;

/// Two words of a dyadic number of any length, and their bound. They are {0, NaN}, of which nothing is known, if the
/// number is outside the range of `is_close`.
///
/// `Scaled` is off by less than 2^-51 of itself: it has the three highest limbs, 64 bits or more, rounded at each step.
/// So is the second word, the rest of the first one.
inline constexpr std::array<double, 3> unknown_words{0, NAN, HUGE_VAL};
template <class P>
std::array<double, 3> words_of(const number::wide::Dyadic<P>& exact) {
    if (exact.sign() == 0) return {0, 0, 0};
    const double high = exact.scaled().value();
    if (!(std::fabs(high) >= least_result && std::fabs(high) <= largest_result)) return unknown_words;
    const double low = (exact - number::wide::Dyadic<P>(high)).scaled().value(), sum = high + low;
    return {sum, low - (sum - high), std::fabs(low) * 0x1p-50 + 0x1p-1000};
}

/// The value and, if `with_slope`, the slope of the polynomial at the origin of one ray, exactly. `in` holds the ray
/// and the primitive. Nothing is known if a number of these is outside [2^-300, 2^300], where sums might be too long.
template <template <class> class Of, class P, std::size_t count>
[[gnu::noinline]] static void find_exact_start(const std::array<double, count>& in, bool with_slope,
                                               std::array<std::array<double, 3>, 2>& out) {
    using D = number::wide::Dyadic<P>;
    out = {unknown_words, unknown_words};
    for (const double x : in)
        if (x != 0 && !(std::fabs(x) >= 0x1p-300 && std::fabs(x) <= 0x1p+300)) return;
    const auto at = [&](std::size_t k) { return D(in[k]); };
    // The value does not depend on the direction, and products with zero take no time.
    const auto way = [&](std::size_t k) { return with_slope ? at(k) : D(0.0); };
    const auto g = primitive_from<Of, D>([&](std::size_t k) {
                       return at(6 + k);
                   }).along({{at(0), at(1), at(2)}, {way(3), way(4), way(5)}});
    out[0] = words_of(g.c[0]);
    if (with_slope) out[1] = words_of(g.c[1]);
}

/// Replaces the value and the slope of a polynomial at the origin by exact ones, in the lanes of two masks.
template <template <class> class Of, class P, std::size_t count>
void make_exact(const std::array<P, count>& in, const mask_t<P>& value, const mask_t<P>& slope,
                Polynomial<Running<TwoWords<P>>>& g) {
    if (!any_of(value || slope)) return;
    bool lanes[P::lanes], with_slope[P::lanes];
    (value || slope).store(lanes), slope.store(with_slope);
    double numbers[count][P::lanes], words[2][3][P::lanes] = {};
    for (std::size_t k = 0; k < count; ++k) in[k].store(numbers[k]);
    for (std::size_t lane = 0; lane < P::lanes; ++lane) {
        if (!lanes[lane]) continue;
        std::array<double, count> problem;
        for (std::size_t k = 0; k < count; ++k) problem[k] = numbers[k][lane];
        std::array<std::array<double, 3>, 2> exact;
        find_exact_start<Of, P>(problem, with_slope[lane], exact);
        for (std::size_t power = 0; power < 2; ++power)
            for (std::size_t k = 0; k < 3; ++k) words[power][k][lane] = exact[power][k];
    }
    for (std::size_t power = 0; power < 2; ++power) {
        const auto word = [&](std::size_t k) { return P::load(words[power][k]); };
        g.c[power] = select(power == 0 ? value : slope, Running<TwoWords<P>>(TwoWords<P>(word(0), word(1)), word(2)),
                            g.c[power]);
    }
}

/// Roots of g(t) = g₀ + g₁ t + … + g₄ t⁴, g₄ > 0, between 0 and a `reach` T, where g or its slope is monotone:
///
///     steady   |g′ − g₁| ≤ 2|g₂|T + 3|g₃|T² + 4 g₄T³ ≤ |g₁|/2 on [0, T]: g is monotone there, and has one root or none
///     bent     |g″/2 − g₂| ≤ 3|g₃|T + 6 g₄T² ≤ |g₂|/2 on [0, T]: with s the sign of g₂, h = s g is convex there, and
///              h″ ≥ |g₂|. If h(0) < 0, it has a root if h(T) > 0, and none if h(T) < 0. If h(0) > 0 and h′(0) ≥ 0, it
///              has none. Nor has it any if h(m) > h′(m)²/(2|g₂|) at some m of [0, T], since h(t) ≥ h(m) + h′(m)(t − m)
///              + |g₂|(t − m)²/2
///
/// Let g have the sign of g₀ at a point of [0, T], and the other sign at a later one. Then the first root lies between
/// them: it is the only one, or g (h > 0 at first) leaves the sign of g₀ at the first of two roots and returns to it at
/// the second.
template <class P>
class RootsFromStart {
public:
    using W = TwoWords<P>;
    using E = Running<W>;
    using Mask = mask_t<P>;

    /// All roots lie within ±`length`.
    RootsFromStart(const Polynomial<E>& g, const P& length) : g_(g), slope_(g.slope()) {
        const E zero(0);
        above_ = (g.c[0] > zero).yes(), below_ = (g.c[0] < zero).yes();
        up_ = (g.c[1] > zero).yes(), down_ = (g.c[1] < zero).yes();
        rise_ = (g.c[2] > zero).yes(), fall_ = (g.c[2] < zero).yes();
        const P bent = bent_reach(), steady = steady_reach(length);
        const auto is_bent = (rise_ || fall_) && is_within(bent, 2), is_steady = (up_ || down_) && is_within(steady, 1);
        steady_ = is_steady && !(is_bent && bent >= steady);
        known_ = is_bent || is_steady;
        reach_ = select(steady_, steady, bent);
    }

    [[nodiscard]] const P& reach() const { return reach_; }
    /// Masks of the rays whose sign of g′ at the origin is proved to be + or −, and the same for g″.
    [[nodiscard]] Mask crosses() const { return up_ || down_; }
    [[nodiscard]] Mask bends() const { return rise_ || fall_; }

    /// Proves that g has no root in [0, T].
    [[nodiscard]] Mask none() const {
        const E zero(0), at_end = g_.at(E(W(reach_)));
        const auto keeps = (above_ && (at_end > zero).yes()) || (below_ && (at_end < zero).yes());
        const auto leaves = (above_ && up_) || (below_ && down_);
        const auto turned = (rise_ && (g_.c[1] >= zero).yes()) || (fall_ && (g_.c[1] <= zero).yes());
        return known_ && ((steady_ && (leaves || keeps)) || (!steady_ && low() && keeps) ||
                          (!steady_ && high() && (turned || stays_high())));
    }

    /// The first root, if it lies in [0, T].
    [[nodiscard]] FirstRoot<E> first() const {
        using lostbits::abs, lostbits::max;
        E x{W(near_root())};
        for (int i = 0; i < 2; ++i) x = E((x - g_.at(x) / E(slope_.at(x).words())).words());
        const E off = g_.at(x) / E(slope_.at(x).words());
        const E away{W(P(2) * (abs(off.first()) + off.radius()) + P(0x1p-110) * abs(x.first()))};
        const E low_end{(x - away).words()}, high_end{(x + away).words()}, zero(0);
        const E to_low = x - low_end, to_high = high_end - x;
        const P radius = max(abs(to_low.first()) + to_low.radius(), abs(to_high.first()) + to_high.radius());
        const E before = g_.at(low_end), behind = g_.at(high_end);
        const auto changes = (above_ && (before > zero).yes() && (behind < zero).yes()) ||
                             (below_ && (before < zero).yes() && (behind > zero).yes());
        const auto inside = (low_end > zero).yes() && (high_end <= E(W(reach_))).yes();
        return {known_ && changes && inside, none(), low_end, high_end, E(x.words(), radius * P(1 + 0x1p-40))};
    }

private:
    [[nodiscard]] P size(std::size_t k) const {
        using lostbits::abs;
        return abs(g_.c[k].first());
    }
    /// A little less than the inequalities allow. `is_within` proves them.
    static constexpr double most = 0.96;
    [[nodiscard]] P bent_reach() const {
        using lostbits::min, lostbits::sqrt;
        return P(most) * min(size(2) / (P(12) * size(3)), sqrt(size(2) / (P(24) * size(4))));
    }
    [[nodiscard]] P steady_reach(const P& length) const {
        using lostbits::min, lostbits::sqrt;
        const P rest = min(size(1) / (P(24) * size(4) * length * length * length), P(1));
        return P(most) * min(min(size(1) / (P(12) * size(2)), sqrt(size(1) / (P(18) * size(3)))), length * rest);
    }
    /// The inequality of `steady` (power 1) or of `bent` (power 2). The reach keeps it by 4 % with the words of the
    /// coefficients alone. It fails where the bounds of these words matter: the second coefficient may be a tenth of
    /// its word.
    [[nodiscard]] Mask is_within(const P& reach, std::size_t power) const {
        const E t{W(reach)}, half(W(P(0.5)));
        const E later = E(3) * abs(g_.c[3]) * t;
        const E change = power == 2 ? later + E(6) * g_.c[4] * square(t)
                                    : (E(2) * abs(g_.c[2]) + later) * t + E(4) * g_.c[4] * (square(t) * t);
        return reach > P(0) && (change <= half * abs(g_.c[power])).yes();
    }
    [[nodiscard]] Mask high() const { return (rise_ && above_) || (fall_ && below_); }
    [[nodiscard]] Mask low() const { return (rise_ && below_) || (fall_ && above_); }
    /// h(m) > h′(m)²/(2|g₂|), with m near the lowest point of h. There the words of h′ nearly vanish, and their bound
    /// remains.
    [[nodiscard]] Mask stays_high() const {
        using lostbits::max, lostbits::min;
        P m(0);
        for (int i = 0; i < 4; ++i) {
            const P slope = ((P(4) * word(4) * m + P(3) * word(3)) * m + P(2) * word(2)) * m + word(1);
            const P bend = (P(12) * word(4) * m + P(6) * word(3)) * m + P(2) * word(2);
            m = min(max(m - slope / bend, P(0)), reach_);
        }
        const E at{W(m)}, value = g_.at(at), slope = slope_.at(at), sunk = square(slope) / (E(2) * abs(g_.c[2]));
        return (rise_ && (value > sunk).yes()) || (fall_ && (-value > sunk).yes());
    }
    [[nodiscard]] const P& word(std::size_t k) const { return g_.c[k].first(); }
    /// Approximates the smaller positive root of g₀ + g₁ t + g₂ t², and then that of g, by Newton's method.
    [[nodiscard]] P near_root() const {
        using lostbits::copysign, lostbits::max, lostbits::sqrt;
        const P root = sqrt(max(word(1) * word(1) - P(4) * word(0) * word(2), P(0)));
        const P q = P(-0.5) * (word(1) + copysign(root, word(1))), one = word(0) / q, other = q / word(2);
        P x = select(one > P(0) && !(other > P(0) && other < one), one, other);
        for (int i = 0; i < 4; ++i) {
            const P value = (((word(4) * x + word(3)) * x + word(2)) * x + word(1)) * x + word(0);
            const P slope = ((P(4) * word(4) * x + P(3) * word(3)) * x + P(2) * word(2)) * x + word(1);
            const P next = x - value / slope;
            x = select(next > P(0), next, x);
        }
        return x;
    }

    const Polynomial<E>& g_;
    Polynomial<E> slope_;
    P reach_;
    Mask above_, below_, up_, down_, rise_, fall_, steady_, known_;
};

/// The answer of `truth::enclose` for the usual convention. On the surface (g₀ = 0) the ray hits at t = 0. It touches
/// there if g₁ = 0 and g₂ ≠ 0: g does not change its sign. Otherwise the first root lies within the reach, or is the
/// first one of `span` behind it. A slope that nearly vanishes is needed exactly, too: the ray lies in the tangent
/// plane.
template <template <class> class Of, class P, std::size_t count>
[[gnu::noinline]] TieFinding<P> settle_start(const std::array<P, 6>& ray, const std::array<P, count>& primitive,
                                             const RequestedResults& asked) {
    using W = TwoWords<P>;
    using E = Running<W>;
    using lostbits::abs;
    std::array<P, 6 + count> all;
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k < 6 ? ray[k] : primitive[k - 6];
    std::array<E, count> numbers;
    for (std::size_t k = 0; k < count; ++k) numbers[k] = E(W(primitive[k]));
    const auto at = [&](std::size_t k) { return E(W(ray[k])); };
    const Ray<E> line{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
    const Of<E> shape = primitive_from<Of, E>([&](std::size_t k) { return numbers[k]; });
    const auto span = shape.span(line);
    const E zero(0);
    const auto proper =
        is_proper<Of<E>>(numbers) && (span.d2 > zero).yes() && sum_of_sizes(ray[0], ray[1], ray[2]) < P(HUGE_VAL);

    Polynomial<E> g = shape.along(line);
    const auto is_rough = [](const E& x, double most) { return !(x.radius() <= P(most) * abs(x.first())); };
    make_exact<Of>(all, is_rough(g.c[0], 0x1p-78), is_rough(g.c[1], 0x1p-60), g);
    const auto at_origin = (g.c[0] <= zero).yes() && (g.c[0] >= zero).yes();
    const RootsFromStart<P> near(g, span.bound.first() / span.a.first());
    const auto touches = at_origin && (g.c[1] <= zero).yes() && (g.c[1] >= zero).yes() && near.bends();
    const FirstRoot<E> start = near.first();
    const E begin{span.place(E(W(P(0.5) * near.reach()))).words()};
    const auto behind = start.none && (begin > span.b).yes() && (begin < span.place(E(W(near.reach())))).yes();
    const FirstRoot<E> later = first_root(span.f, begin, span.bound);

    const auto missed = proper && behind && later.none;
    auto hit = proper && ((at_origin && (touches || near.crosses())) || start.found || (behind && later.found));
    const E t = select(start.found, start.x, span.time(later.x));
    const Enclosure<P> nothing{{P(0), P(0)}, P(0)};
    TieFinding<P> tie{{missed, hit, nothing, nothing}, touches, at_origin};
    if (asked.t) tie.found.t = kept_length(t, at_origin, at_origin, hit);
    if (asked.distance) tie.found.distance = kept_length(t * sqrt(span.d2), at_origin, at_origin, hit);
    tie.found.settled = hit || missed;
    tie.found.hit = hit;
    return tie;
}

}  // namespace lostbits::measure::stages
