// Decides for all problems near one whether the ray hits a torus, without the roots of the quartic.
#pragma once

#include <algorithm>
#include <cmath>

#include "measure/stability/cases.hpp"

namespace lostbits::measure::stability {

/// Part of a torus that a ray hits if its quartic f has two minima and a maximum between them: before the maximum or
/// behind it. `unspecified` if f has one minimum, or if the part is not known.
enum class TorusPass : std::uint8_t { unspecified, first, second };

/// Decision about a ray and a primitive, and the crossing at which the ray hits.
struct SpanDecision {
    Tri hit = Tri::unknown;
    Crossing at = Crossing::begin;
    TorusPass pass = TorusPass::unspecified;

    [[nodiscard]] bool is_same(const SpanDecision& other, CountedChange counted) const {
        if (!(hit == other.hit)) return false;
        const bool has_other_pass =
            pass != TorusPass::unspecified && other.pass != TorusPass::unspecified && pass != other.pass;
        return counted == CountedChange::decision || (at == other.at && !has_other_pass);
    }
};

/// Critical points of a quartic, approximated from the middle of its enclosure. The first and the last are minima; of
/// three points, the second is the maximum.
struct CriticalPoints {
    ApproximateRoots<double> points;

    template <class E>
    explicit CriticalPoints(const QuarticSpan<E>& span) {
        Polynomial<double> f{{}, 4};
        for (int i = 0; i <= 4; ++i) f.coefficient(i) = value_of(span.f.coefficient(i));
        points = approximate_roots(f.derivative(), value_of(span.bound));
    }
    [[nodiscard]] std::optional<double> maximum() const {
        return points.count == 3 ? std::optional(points.x[1]) : std::nullopt;
    }

private:
    static double value_of(const Ball& x) { return x.hi(); }
    static double value_of(const Near& x) { return x.hi(); }
    static double value_of(const Interval& x) { return mpfr_get_d(x.lower(), MPFR_RNDN); }
};

/// Proves where f has no root and where it has one. For x within H of m, f = Σ cₖ hᵏ. If 2 c₂′ is a lower bound of f″,
/// f ≥ c₀ + c₁ h + c₂′ h², which is positive if 4 c₀ c₂′ > c₁². If m is the minimum, c₁ is about 0, and the bound is
/// exact to first order.
class QuarticCases {
public:
    QuarticCases(const QuarticSpan<Near>& span, const SpanRange<Near>* range, intersect::Convention convention,
                 CountedChange counted, Cases& cases)
        : span_(span),
          range_(range),
          convention_(convention),
          counted_(counted),
          cases_(cases),
          critical_points_(span),
          begin_(range ? span.x_at(range->begin) : span.b) {
        if (range && (range->end.m > Near(0)).is_yes()) end_ = span.x_at(range->end.n);
    }

    [[nodiscard]] SpanDecision decide() {
        const Near at_begin = span_.f.at(begin_), zero(0);
        const Tri outside = at_begin > zero, inside = at_begin < zero;
        Near::OpenComparisons* const outer_open = Near::open_comparisons;
        Near::open_comparisons = nullptr;
        const SpanDecision decision = outside.is_yes()                    ? decide_from_outside()
                                      : inside.is_yes()                   ? decide_from_inside()
                                      : outside.is_no() && inside.is_no() ? decide_from_surface()
                                                                          : SpanDecision{};
        Near::open_comparisons = outer_open;
        return decision;
    }

private:
    [[nodiscard]] SpanDecision decide_from_surface() const {
        const bool counts_as_hit =
            convention_.at_origin == intersect::AtOrigin::hit && convention_.touching == intersect::Touching::hit;
        return counts_as_hit ? SpanDecision{Tri::yes} : SpanDecision{};
    }
    [[nodiscard]] bool is_ahead(double x) const { return Near(Near(x) - begin_).lowest() > 0; }
    [[nodiscard]] bool is_before_end(double x) const { return !end_ || Near(*end_ - Near(x)).lowest() > 0; }
    [[nodiscard]] double last_position() const {
        return std::min(end_ ? end_->highest() : HUGE_VAL, span_.bound.highest() * (1 + 0x1p-40));
    }

    [[nodiscard]] SpanDecision decide_from_outside() {
        const auto maximum = critical_points_.maximum();

        // A minimum below 0 proves a hit before it; with a maximum between, the second pass may come first.
        for (int i = 0; i < critical_points_.points.count; i += 2) {
            const double x = critical_points_.points.x[i];
            if (!is_ahead(x) || !is_before_end(x)) continue;
            const Near at_minimum = span_.f.at(Near(x));
            if (!(at_minimum.highest() < 0)) {
                if (!(at_minimum.lowest() > 0)) cases_.watch(at_minimum);
                continue;
            }
            if (!maximum) return {Tri::yes, Crossing::near};
            if (x < *maximum) return {Tri::yes, Crossing::near, TorusPass::first};
            if (counted_ == CountedChange::decision) return {Tri::yes, Crossing::near};
            if (!is_positive_from(begin_.lowest(), *maximum, 1)) return {};
            return {Tri::yes, Crossing::near, TorusPass::second};
        }

        // So does a value below 0 at the end of the ray.
        if (end_) {
            const Near at_end = span_.f.at(*end_);
            if (at_end.highest() < 0)
                return counted_ == CountedChange::decision || !maximum || end_->highest() < *maximum
                           ? SpanDecision{Tri::yes, Crossing::near, maximum ? TorusPass::first : TorusPass::unspecified}
                       : is_positive_from(begin_.lowest(), *maximum, 1)
                           ? SpanDecision{Tri::yes, Crossing::near, TorusPass::second}
                           : SpanDecision{};
            if (!(at_end.lowest() > 0)) cases_.watch(at_end);
        }
        return is_positive_from(begin_.lowest(), last_position(), 1) ? SpanDecision{Tri::no} : SpanDecision{};
    }

    [[nodiscard]] SpanDecision decide_from_inside() {
        using intersect::Inside;
        if (convention_.inside == Inside::miss) return {Tri::no};
        if (convention_.inside == Inside::zero) return {Tri::yes};
        const auto maximum = critical_points_.maximum();
        if (end_) {
            const Near at_end = span_.f.at(*end_);
            const bool leaves_before_end =
                at_end.lowest() > 0 ||
                (maximum && is_ahead(*maximum) && is_before_end(*maximum) && span_.f.at(Near(*maximum)).lowest() > 0);
            if (!leaves_before_end) {
                cases_.watch(at_end);
                return is_positive_from(begin_.lowest(), end_->highest(), -1) ? SpanDecision{Tri::no} : SpanDecision{};
            }
        }
        if (counted_ == CountedChange::decision || !maximum) return {Tri::yes, Crossing::far};
        const Near at_maximum = span_.f.at(Near(*maximum));
        if (is_ahead(*maximum)) {
            if (at_maximum.lowest() > 0) return {Tri::yes, Crossing::far, TorusPass::first};
            if (!(at_maximum.highest() < 0)) cases_.watch(at_maximum);
        }
        const double second_minimum = critical_points_.points.x[2];
        const bool stays_inside = !is_ahead(second_minimum) || is_positive_from(begin_.lowest(), second_minimum, -1);
        return stays_inside ? SpanDecision{Tri::yes, Crossing::far, TorusPass::second} : SpanDecision{};
    }

    /// True if `sign` times f is proved positive from `low` to `high`, for all problems.
    [[nodiscard]] bool is_positive_from(double low, double high, int sign) {
        piece_count_ = 0;
        const double bound = span_.bound.highest() * (1 + 0x1p-40);
        if (sign > 0) low = std::max(low, -bound);
        double proved_to = low;
        for (int i = sign > 0 ? 0 : 1; i < critical_points_.points.count; i += 2) {
            const double x = critical_points_.points.x[i];
            if (!(x > proved_to && x < high)) continue;
            // Around a minimum, the piece is as wide as the quadratic term is known not to vanish.
            const TaylorExpansion expansion(span_.f, x, sign);
            const double c2 = expansion.c[2].lowest(), c3 = magnitude(expansion.c[3]);
            if (!(c2 > 0)) continue;
            double half_width = std::min(high - x, x - proved_to);
            if (half_width * c3 * 4 > c2) half_width = c2 / (4 * c3);
            if (half_width == 0 || !is_positive(x - half_width, x + half_width, sign) ||
                !is_positive(proved_to, x - half_width, sign))
                return false;
            proved_to = x + half_width;
        }
        return proved_to >= high || is_positive(proved_to, high, sign);
    }

    static double magnitude(const Near& x) { return std::max(std::fabs(x.lowest()), std::fabs(x.highest())); }

    struct TaylorExpansion {
        std::array<Near, 5> c;
        TaylorExpansion(const Polynomial<Near>& f, double m, int sign) {
            const Near x(m);
            for (int i = 0; i <= 4; ++i) c[i] = sign > 0 ? f.coefficient(i) : -f.coefficient(i);
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t i = 4; i-- > k;) c[i] = c[i] + c[i + 1] * x;
        }
    };

    [[nodiscard]] bool is_positive(double low, double high, int sign) {
        if (!(low < high)) return true;
        if (++piece_count_ > max_pieces) return false;
        const double middle = low + (high - low) / 2,
                     half_width = std::max(high - middle, middle - low) * (1 + 0x1p-50);
        const auto [c] = TaylorExpansion(span_.f, middle, sign);
        const double slack = half_width * magnitude(c[3]) + std::max(0.0, -c[4].lowest()) * half_width * half_width;
        const double curvature = c[2].lowest() - slack - (std::fabs(c[2].lowest()) + slack) * 0x1p-48;
        if (c[0].lowest() > (magnitude(c[1]) + std::max(0.0, -curvature) * half_width) * half_width * (1 + 0x1p-48))
            return true;
        if (curvature > 0 && Near(Near(4 * curvature) * c[0] - c[1] * c[1]).lowest() > 0) return true;
        if (c[0].highest() < 0 || !(middle > low && middle < high)) return false;
        return is_positive(low, middle, sign) && is_positive(middle, high, sign);
    }

    static constexpr int max_pieces = 48;
    const QuarticSpan<Near>& span_;
    const SpanRange<Near>* range_;
    intersect::Convention convention_;
    CountedChange counted_;
    Cases& cases_;
    CriticalPoints critical_points_;
    Near begin_;
    std::optional<Near> end_;
    int piece_count_ = 0;
};

}  // namespace lostbits::measure::stability
