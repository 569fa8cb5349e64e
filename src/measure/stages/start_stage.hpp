// Settles rays that begin near or on a surface of degree four, many at once. The first crossing of such a ray lies so
// close to the origin that the sums of `span` lose it. The polynomial along the ray, whose parameter is 0 at the
// origin, keeps it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "geometry/first_root.hpp"
#include "measure/stages/span_stages.hpp"
#include "measure/stages/tie_stage.hpp"
#include "number/wide/dyadic.hpp"

namespace lostbits::measure::stages {

/// Selects shapes with a polynomial of degree four along a ray (`polynomial_along`) and the usual convention.
template <class S>
inline constexpr bool is_quartic_along = false;
template <template <class> class ShapeOver, class E>
requires requires(const ShapeOver<E>& shape, const Ray<E>& ray) { shape.polynomial_along(ray); }
inline constexpr bool is_quartic_along<ShapeOver<E>> = true;

/// Two words of a dyadic number of any length, and their bound. If the number is outside the range of `is_close`, the
/// words are {0, NaN} and the bound is infinite: nothing is known about the number.
///
/// `ScaledDouble` is off by less than 2^-51 of itself: it has the three highest limbs, 64 bits or more, rounded at each
/// step. The second word is the rest after the first, computed in the same way, so it is also off by less than 2^-51 of
/// itself.
inline constexpr std::array<double, 3> unknown_words{0, NAN, HUGE_VAL};
template <class P>
std::array<double, 3> words_of(const number::wide::Dyadic<P>& exact) {
    if (exact.sign() == 0) return {0, 0, 0};
    const double high = exact.scaled().value();
    if (!(std::fabs(high) >= min_result && std::fabs(high) <= largest_result)) return unknown_words;
    const double low = (exact - number::wide::Dyadic<P>(high)).scaled().value(), sum = high + low;
    return {sum, low - (sum - high), std::fabs(low) * 0x1p-50 + 0x1p-1000};
}

/// Computes the value and, if `with_slope`, the slope of the polynomial at the origin of one ray, exactly. `numbers`
/// holds the ray and the primitive. If the size of a number is neither 0 nor within [2^-300, 2^300], where sums might
/// be too long, nothing is known about the results.
template <template <class> class ShapeOver, class P, std::size_t count>
[[gnu::noinline]] static void find_exact_start(const std::array<double, count>& numbers, bool with_slope,
                                               std::array<std::array<double, 3>, 2>& out) {
    using D = number::wide::Dyadic<P>;
    out = {unknown_words, unknown_words};
    for (const double x : numbers)
        if (x != 0 && !(std::fabs(x) >= 0x1p-300 && std::fabs(x) <= 0x1p+300)) return;
    const auto exact_number = [&](std::size_t k) { return D(numbers[k]); };
    // The value does not depend on the direction, and products with zero cost no time.
    const auto exact_direction = [&](std::size_t k) { return with_slope ? exact_number(k) : D(0.0); };
    const auto g = primitive_from<ShapeOver, D>([&](std::size_t k) { return exact_number(6 + k); })
                       .polynomial_along({{exact_number(0), exact_number(1), exact_number(2)},
                                          {exact_direction(3), exact_direction(4), exact_direction(5)}});
    out[0] = words_of(g.c[0]);
    if (with_slope) out[1] = words_of(g.c[1]);
}

/// Replaces the value and the slope of a polynomial at the origin by exact numbers, in the lanes of the masks `value`
/// and `slope`.
template <template <class> class ShapeOver, class P, std::size_t count>
void make_exact(const std::array<P, count>& problems, const mask_t<P>& value, const mask_t<P>& slope,
                Polynomial<RunningError<TwoWords<P>>>& g) {
    if (!any_of(value || slope)) return;
    bool is_selected[P::lanes], with_slope[P::lanes];
    (value || slope).store(is_selected);
    slope.store(with_slope);
    double numbers[count][P::lanes], words[2][3][P::lanes] = {};
    for (std::size_t k = 0; k < count; ++k) problems[k].store(numbers[k]);

    // Computes lane by lane.
    for (std::size_t lane = 0; lane < P::lanes; ++lane) {
        if (!is_selected[lane]) continue;
        std::array<double, count> problem;
        for (std::size_t k = 0; k < count; ++k) problem[k] = numbers[k][lane];
        std::array<std::array<double, 3>, 2> exact;
        find_exact_start<ShapeOver, P>(problem, with_slope[lane], exact);
        for (std::size_t power = 0; power < 2; ++power)
            for (std::size_t k = 0; k < 3; ++k) words[power][k][lane] = exact[power][k];
    }

    for (std::size_t power = 0; power < 2; ++power) {
        const auto word = [&](std::size_t k) { return P::load(words[power][k]); };
        g.c[power] = select(power == 0 ? value : slope,
                            RunningError<TwoWords<P>>(TwoWords<P>(word(0), word(1)), word(2)), g.c[power]);
    }
}

/// Roots of g(t) = g₀ + g₁ t + … + g₄ t⁴, g₄ > 0, between 0 and a `reach` T, where g or its slope is monotone:
///
///     steady   |g′ − g₁| ≤ 2|g₂|T + 3|g₃|T² + 4 g₄T³ ≤ |g₁|/2 on [0, T]: g is monotone there, and has one root or none
///     bent     |g″/2 − g₂| ≤ 3|g₃|T + 6 g₄T² ≤ |g₂|/2 on [0, T]: with s the sign of g₂, h = s g is convex there, and
///              h″ ≥ |g₂|. If h(0) < 0, h has a root if h(T) > 0, and none if h(T) < 0. If h(0) > 0, h has no root if
///              h′(0) ≥ 0, or if h(m) > h′(m)²/(2|g₂|) at some m of [0, T], since h(t) ≥ h(m) + h′(m)(t − m)
///              + |g₂|(t − m)²/2
///
/// Let g have the sign of g₀ at a point of [0, T], and the other sign at a later point. Then the first root lies
/// between the two points: it is the only root, or (if h(0) > 0) g leaves the sign of g₀ at the first of two roots and
/// returns to this sign at the second.
template <class P>
class RootsFromStart {
public:
    using W = TwoWords<P>;
    using E = RunningError<W>;
    using Mask = mask_t<P>;

    /// All roots lie within ±`length`.
    RootsFromStart(const Polynomial<E>& g, const P& length) : g_(g), slope_(g.derivative()) {
        const E zero(0);
        g0_positive_ = (g.c[0] > zero).yes();
        g0_negative_ = (g.c[0] < zero).yes();
        g1_positive_ = (g.c[1] > zero).yes();
        g1_negative_ = (g.c[1] < zero).yes();
        g2_positive_ = (g.c[2] > zero).yes();
        g2_negative_ = (g.c[2] < zero).yes();
        const P bent = bent_reach(), steady = steady_reach(length);
        const auto is_bent = (g2_positive_ || g2_negative_) && is_within(bent, 2),
                   is_steady = (g1_positive_ || g1_negative_) && is_within(steady, 1);
        is_steady_ = is_steady && !(is_bent && bent >= steady);
        is_known_ = is_bent || is_steady;
        reach_ = select(is_steady_, steady, bent);
    }

    [[nodiscard]] const P& reach() const { return reach_; }
    /// Masks of the rays for which the sign of g′ (`crosses`) or of g″ (`bends`) at the origin is proved to be + or −.
    [[nodiscard]] Mask crosses() const { return g1_positive_ || g1_negative_; }
    [[nodiscard]] Mask bends() const { return g2_positive_ || g2_negative_; }

    /// Proves that g has no root in [0, T].
    [[nodiscard]] Mask none() const {
        const E zero(0), at_end = g_.at(E(W(reach_)));
        const auto keeps_sign = (g0_positive_ && (at_end > zero).yes()) || (g0_negative_ && (at_end < zero).yes());
        const auto moves_away = (g0_positive_ && g1_positive_) || (g0_negative_ && g1_negative_);
        const auto does_not_fall =
            (g2_positive_ && (g_.c[1] >= zero).yes()) || (g2_negative_ && (g_.c[1] <= zero).yes());
        return is_known_ &&
               ((is_steady_ && (moves_away || keeps_sign)) || (!is_steady_ && h_negative() && keeps_sign) ||
                (!is_steady_ && h_positive() && (does_not_fall || stays_positive())));
    }

    /// First root, if it lies in [0, T].
    [[nodiscard]] FirstRoot<E> first() const {
        using lostbits::abs, lostbits::max;
        E x{W(near_root())};
        for (int i = 0; i < 2; ++i) x = E((x - g_.at(x) / E(slope_.at(x).words())).words());
        const E newton_step = g_.at(x) / E(slope_.at(x).words());
        const E distance{W(P(2) * (abs(newton_step.first()) + newton_step.radius()) + P(0x1p-110) * abs(x.first()))};
        const E low_end{(x - distance).words()}, high_end{(x + distance).words()}, zero(0);
        const E to_low = x - low_end, to_high = high_end - x;
        const P radius = max(abs(to_low.first()) + to_low.radius(), abs(to_high.first()) + to_high.radius());
        const E value_at_low = g_.at(low_end), value_at_high = g_.at(high_end);
        const auto changes_sign = (g0_positive_ && (value_at_low > zero).yes() && (value_at_high < zero).yes()) ||
                                  (g0_negative_ && (value_at_low < zero).yes() && (value_at_high > zero).yes());
        const auto in_reach = (low_end > zero).yes() && (high_end <= E(W(reach_))).yes();
        return {is_known_ && changes_sign && in_reach, none(), low_end, high_end,
                E(x.words(), radius * P(1 + 0x1p-40))};
    }

private:
    [[nodiscard]] P size(std::size_t k) const {
        using lostbits::abs;
        return abs(g_.c[k].first());
    }
    /// Factor on the longest reach that the inequalities allow for the words alone. `is_within` proves the
    /// inequalities.
    static constexpr double reach_factor = 0.96;
    [[nodiscard]] P bent_reach() const {
        using lostbits::min, lostbits::sqrt;
        return P(reach_factor) * min(size(2) / (P(12) * size(3)), sqrt(size(2) / (P(24) * size(4))));
    }
    [[nodiscard]] P steady_reach(const P& length) const {
        using lostbits::min, lostbits::sqrt;
        const P length_factor = min(size(1) / (P(24) * size(4) * length * length * length), P(1));
        return P(reach_factor) *
               min(min(size(1) / (P(12) * size(2)), sqrt(size(1) / (P(18) * size(3)))), length * length_factor);
    }
    /// Tests the inequality of `steady` (power 1) or of `bent` (power 2). For the words of the coefficients alone, the
    /// reach satisfies it with a margin of 4 %. The test fails where the bounds of these words matter: the second
    /// coefficient may be a tenth of its word.
    [[nodiscard]] Mask is_within(const P& reach, std::size_t power) const {
        const E t{W(reach)}, half(W(P(0.5)));
        const E cubic_term = E(3) * abs(g_.c[3]) * t;
        const E change = power == 2 ? cubic_term + E(6) * g_.c[4] * square(t)
                                    : (E(2) * abs(g_.c[2]) + cubic_term) * t + E(4) * g_.c[4] * (square(t) * t);
        return reach > P(0) && (change <= half * abs(g_.c[power])).yes();
    }
    [[nodiscard]] Mask h_positive() const { return (g2_positive_ && g0_positive_) || (g2_negative_ && g0_negative_); }
    [[nodiscard]] Mask h_negative() const { return (g2_positive_ && g0_negative_) || (g2_negative_ && g0_positive_); }
    /// h(m) > h′(m)²/(2|g₂|), with m near the lowest point of h. At this m the words of h′ nearly vanish, and their
    /// bound remains.
    [[nodiscard]] Mask stays_positive() const {
        using lostbits::max, lostbits::min;
        P m(0);
        for (int i = 0; i < 4; ++i) {
            const P slope = ((P(4) * word(4) * m + P(3) * word(3)) * m + P(2) * word(2)) * m + word(1);
            const P second_derivative = (P(12) * word(4) * m + P(6) * word(3)) * m + P(2) * word(2);
            m = min(max(m - slope / second_derivative, P(0)), reach_);
        }
        const E point{W(m)}, value = g_.at(point), slope = slope_.at(point),
                             depth = square(slope) / (E(2) * abs(g_.c[2]));
        return (g2_positive_ && (value > depth).yes()) || (g2_negative_ && (-value > depth).yes());
    }
    [[nodiscard]] const P& word(std::size_t k) const { return g_.c[k].first(); }
    /// Approximates the smaller positive root of g₀ + g₁ t + g₂ t², and then that of g, by Newton's method.
    [[nodiscard]] P near_root() const {
        using lostbits::copysign, lostbits::max, lostbits::sqrt;
        const P discriminant_root = sqrt(max(word(1) * word(1) - P(4) * word(0) * word(2), P(0)));
        const P q = P(-0.5) * (word(1) + copysign(discriminant_root, word(1))), one_root = word(0) / q,
                other_root = q / word(2);
        P x = select(one_root > P(0) && !(other_root > P(0) && other_root < one_root), one_root, other_root);
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
    Mask g0_positive_, g0_negative_, g1_positive_, g1_negative_, g2_positive_, g2_negative_, is_steady_, is_known_;
};

/// Answer of `truth::enclose` for the usual convention. On the surface (g₀ = 0) the ray hits at t = 0. It touches
/// there if g₁ = 0 and g₂ ≠ 0: g does not change its sign. Otherwise the first root lies within the reach, or it is the
/// first root of `span` behind the reach. A slope that nearly vanishes must be exact, too, since the ray may lie in the
/// tangent plane.
template <template <class> class ShapeOver, class P, std::size_t count>
[[gnu::noinline]] TieFinding<P> settle_start(const std::array<P, 6>& ray, const std::array<P, count>& primitive,
                                             const RequestedResults& requested) {
    using W = TwoWords<P>;
    using E = RunningError<W>;
    using lostbits::abs;

    std::array<P, 6 + count> problems;
    for (std::size_t k = 0; k < problems.size(); ++k) problems[k] = k < 6 ? ray[k] : primitive[k - 6];
    std::array<E, count> numbers;
    for (std::size_t k = 0; k < count; ++k) numbers[k] = E(W(primitive[k]));
    const auto ray_number = [&](std::size_t k) { return E(W(ray[k])); };
    const Ray<E> line{{ray_number(0), ray_number(1), ray_number(2)}, {ray_number(3), ray_number(4), ray_number(5)}};
    const ShapeOver<E> shape = primitive_from<ShapeOver, E>([&](std::size_t k) { return numbers[k]; });
    const auto span = shape.span(line);
    const E zero(0);
    const auto proper = is_proper<ShapeOver<E>>(numbers) && (span.d2 > zero).yes() &&
                        sum_of_sizes(ray[0], ray[1], ray[2]) < P(HUGE_VAL);

    Polynomial<E> g = shape.polynomial_along(line);
    const auto is_rough = [](const E& x, double most) { return !(x.radius() <= P(most) * abs(x.first())); };
    make_exact<ShapeOver>(problems, is_rough(g.c[0], 0x1p-78), is_rough(g.c[1], 0x1p-60), g);
    const auto at_origin = (g.c[0] <= zero).yes() && (g.c[0] >= zero).yes();
    const RootsFromStart<P> roots(g, span.bound.first() / span.a.first());
    const auto touches = at_origin && (g.c[1] <= zero).yes() && (g.c[1] >= zero).yes() && roots.bends();
    const FirstRoot<E> root_in_reach = roots.first();
    const E begin{span.x_at(E(W(P(0.5) * roots.reach()))).words()};
    const auto is_reach_empty =
        root_in_reach.is_absent && (begin > span.b).yes() && (begin < span.x_at(E(W(roots.reach())))).yes();
    const FirstRoot<E> root_behind = first_root(span.f, begin, span.bound);

    const auto missed = proper && is_reach_empty && root_behind.is_absent;
    auto hit = proper && ((at_origin && (touches || roots.crosses())) || root_in_reach.is_found ||
                          (is_reach_empty && root_behind.is_found));
    const E t = select(root_in_reach.is_found, root_in_reach.root, span.t_at(root_behind.root));
    const Enclosure<P> no_length{{P(0), P(0)}, P(0)};
    TieFinding<P> tie{{missed, hit, no_length, no_length}, touches, at_origin};
    if (requested.t) tie.found.t = accept_length(t, at_origin, at_origin, hit);
    if (requested.distance) tie.found.distance = accept_length(t * sqrt(span.d2), at_origin, at_origin, hit);
    tie.found.settled = hit || missed;
    tie.found.hit = hit;
    return tie;
}

}  // namespace lostbits::measure::stages
