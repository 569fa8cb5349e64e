// The decision of a torus for all problems near one, without its roots.
#pragma once

#include <algorithm>
#include <cmath>

#include "measure/stability/cases.hpp"

namespace lostbits::measure::stability {

/// Part of a torus that a ray meets, where its quartic f has two minima and a maximum between them: before the maximum
/// or behind it. `either` where f has one minimum.
enum class TorusPass : std::uint8_t { either, first, second };

/// The meeting of a ray and a primitive.
struct SpanDecision {
    Tri hit = Tri::unknown;
    Crossing at = Crossing::begin;
    TorusPass pass = TorusPass::either;

    [[nodiscard]] bool is_same(const SpanDecision& other, CountedChange turned) const {
        if (!(hit == other.hit)) return false;
        const bool other_pass = pass != TorusPass::either && other.pass != TorusPass::either && pass != other.pass;
        return turned == CountedChange::decision || (at == other.at && !other_pass);
    }
};

/// Critical points of a quartic, approximated from its middle: minima at the ends and, of three, the maximum.
struct Turns {
    NearRoots<double> at;

    template <class E>
    explicit Turns(const QuarticSpan<E>& s) {
        Polynomial<double> f{{}, 4};
        for (int i = 0; i <= 4; ++i) f.of(i) = value_of(s.f.of(i));
        at = near_roots(f.slope(), value_of(s.bound));
    }
    [[nodiscard]] std::optional<double> maximum() const {
        return at.count == 3 ? std::optional(at.x[1]) : std::nullopt;
    }

private:
    static double value_of(const Ball& x) { return x.hi(); }
    static double value_of(const Near& x) { return x.hi(); }
    static double value_of(const Interval& x) { return mpfr_get_d(x.lower(), MPFR_RNDN); }
};

/// Proves where f has no root and where it has one. For x within H of m, f = Σ cₖ hᵏ. If 2 c₂′ is a lower bound of f″,
/// f ≥ c₀ + c₁ h + c₂′ h², which is positive if 4 c₀ c₂′ > c₁². With m at the minimum, c₁ is about 0, and the bound is
/// exact to first order.
class QuarticCases {
public:
    QuarticCases(const QuarticSpan<Near>& s, const RangeOfSpan<Near>* range, intersect::Convention asked,
                 CountedChange turned, Cases& cases)
        : span_(s),
          range_(range),
          asked_(asked),
          turned_(turned),
          cases_(cases),
          turns_(s),
          begin_(range ? s.place(range->begin) : s.b) {
        if (range && (range->end.m > Near(0)).is_yes()) end_ = s.place(range->end.n);
    }

    [[nodiscard]] SpanDecision find() {
        const Near at_begin = span_.f.at(begin_), nothing(0);
        const Tri outside = at_begin > nothing, inside = at_begin < nothing;
        Near::Open* const outer = Near::open;
        Near::open = nullptr;
        const SpanDecision met = outside.is_yes()                    ? from_outside()
                                 : inside.is_yes()                   ? from_inside()
                                 : outside.is_no() && inside.is_no() ? from_surface()
                                                                     : SpanDecision{};
        Near::open = outer;
        return met;
    }

private:
    [[nodiscard]] SpanDecision from_surface() const {
        const bool counts = asked_.at_origin == intersect::AtOrigin::hit && asked_.touching == intersect::Touching::hit;
        return counts ? SpanDecision{Tri::yes} : SpanDecision{};
    }
    [[nodiscard]] bool is_ahead(double x) const { return Near(Near(x) - begin_).lowest() > 0; }
    [[nodiscard]] bool is_before_end(double x) const { return !end_ || Near(*end_ - Near(x)).lowest() > 0; }
    [[nodiscard]] double last() const {
        return std::min(end_ ? end_->highest() : HUGE_VAL, span_.bound.highest() * (1 + 0x1p-40));
    }

    [[nodiscard]] SpanDecision from_outside() {
        const auto maximum = turns_.maximum();
        for (int i = 0; i < turns_.at.count; i += 2) {
            const double x = turns_.at.x[static_cast<std::size_t>(i)];
            if (!is_ahead(x) || !is_before_end(x)) continue;
            const Near least = span_.f.at(Near(x));
            if (!(least.highest() < 0)) {
                if (!(least.lowest() > 0)) cases_.watch(least);
                continue;
            }
            if (!maximum) return {Tri::yes, Crossing::near};
            if (x < *maximum) return {Tri::yes, Crossing::near, TorusPass::first};
            if (turned_ == CountedChange::decision) return {Tri::yes, Crossing::near};
            if (!is_positive_from(begin_.lowest(), *maximum, 1)) return {};
            return {Tri::yes, Crossing::near, TorusPass::second};
        }
        if (end_) {
            const Near at_end = span_.f.at(*end_);
            if (at_end.highest() < 0)
                return turned_ == CountedChange::decision || !maximum || end_->highest() < *maximum
                           ? SpanDecision{Tri::yes, Crossing::near, maximum ? TorusPass::first : TorusPass::either}
                       : is_positive_from(begin_.lowest(), *maximum, 1)
                           ? SpanDecision{Tri::yes, Crossing::near, TorusPass::second}
                           : SpanDecision{};
            if (!(at_end.lowest() > 0)) cases_.watch(at_end);
        }
        return is_positive_from(begin_.lowest(), last(), 1) ? SpanDecision{Tri::no} : SpanDecision{};
    }

    [[nodiscard]] SpanDecision from_inside() {
        using intersect::Inside;
        if (asked_.inside == Inside::miss) return {Tri::no};
        if (asked_.inside == Inside::zero) return {Tri::yes};
        const auto maximum = turns_.maximum();
        if (end_) {
            const Near at_end = span_.f.at(*end_);
            const bool leaves = at_end.lowest() > 0 || (maximum && is_ahead(*maximum) && is_before_end(*maximum) &&
                                                        span_.f.at(Near(*maximum)).lowest() > 0);
            if (!leaves) {
                cases_.watch(at_end);
                return is_positive_from(begin_.lowest(), end_->highest(), -1) ? SpanDecision{Tri::no} : SpanDecision{};
            }
        }
        if (turned_ == CountedChange::decision || !maximum) return {Tri::yes, Crossing::far};
        const Near most = span_.f.at(Near(*maximum));
        if (is_ahead(*maximum)) {
            if (most.lowest() > 0) return {Tri::yes, Crossing::far, TorusPass::first};
            if (!(most.highest() < 0)) cases_.watch(most);
        }
        const double second = turns_.at.x[2];
        const bool stays = !is_ahead(second) || is_positive_from(begin_.lowest(), second, -1);
        return stays ? SpanDecision{Tri::yes, Crossing::far, TorusPass::second} : SpanDecision{};
    }

    /// True if `sign` times f is proved positive from `low` to `high`, for all problems.
    [[nodiscard]] bool is_positive_from(double low, double high, int sign) {
        pieces_ = 0;
        const double bound = span_.bound.highest() * (1 + 0x1p-40);
        if (sign > 0) low = std::max(low, -bound);
        double from = low;
        for (int i = sign > 0 ? 0 : 1; i < turns_.at.count; i += 2) {
            const double x = turns_.at.x[static_cast<std::size_t>(i)];
            if (!(x > from && x < high)) continue;
            // About a minimum the piece is as wide as the quadratic term is known not to vanish.
            const Taylor at(span_.f, x, sign);
            const double c2 = at.c[2].lowest(), c3 = size(at.c[3]);
            if (!(c2 > 0)) continue;
            double half = std::min(high - x, x - from);
            if (half * c3 * 4 > c2) half = c2 / (4 * c3);
            if (half == 0 || !is_positive(x - half, x + half, sign) || !is_positive(from, x - half, sign)) return false;
            from = x + half;
        }
        return from >= high || is_positive(from, high, sign);
    }

    static double size(const Near& x) { return std::max(std::fabs(x.lowest()), std::fabs(x.highest())); }

    struct Taylor {
        std::array<Near, 5> c;
        Taylor(const Polynomial<Near>& f, double m, int sign) {
            const Near x(m);
            for (int i = 0; i <= 4; ++i) c[static_cast<std::size_t>(i)] = sign > 0 ? f.of(i) : -f.of(i);
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t i = 4; i-- > k;) c[i] = c[i] + c[i + 1] * x;
        }
    };

    [[nodiscard]] bool is_positive(double low, double high, int sign) {
        if (!(low < high)) return true;
        if (++pieces_ > most_pieces) return false;
        const double middle = low + (high - low) / 2, half = std::max(high - middle, middle - low) * (1 + 0x1p-50);
        const auto [c] = Taylor(span_.f, middle, sign);
        const double less = half * size(c[3]) + std::max(0.0, -c[4].lowest()) * half * half;
        const double bend = c[2].lowest() - less - (std::fabs(c[2].lowest()) + less) * 0x1p-48;
        if (c[0].lowest() > (size(c[1]) + std::max(0.0, -bend) * half) * half * (1 + 0x1p-48)) return true;
        if (bend > 0 && Near(Near(4 * bend) * c[0] - c[1] * c[1]).lowest() > 0) return true;
        if (c[0].highest() < 0 || !(middle > low && middle < high)) return false;
        return is_positive(low, middle, sign) && is_positive(middle, high, sign);
    }

    static constexpr int most_pieces = 48;
    const QuarticSpan<Near>& span_;
    const RangeOfSpan<Near>* range_;
    intersect::Convention asked_;
    CountedChange turned_;
    Cases& cases_;
    Turns turns_;
    Near begin_;
    std::optional<Near> end_;
    int pieces_ = 0;
};

}  // namespace lostbits::measure::stability
