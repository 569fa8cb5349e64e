#include "measure/stability/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "measure/stability/quartic_cases.hpp"
#include "measure/truth/missing.hpp"
#include "shapes/bounding_box.hpp"
#include "shapes/capsule/parts.hpp"

namespace lostbits::measure::stability {

namespace {

constexpr double least_change = 0x1p-90, most_change = 0.5;

/// Largest ε for which `holds` is proved, to a factor of 2^(1/16), or of 2 from `most_tight` on, and at most
/// `most_change`; 0 where not even `least_change` is proved. What holds within ε holds within less, too. `guess()` is
/// asked after each ε that is not proved: a guess at the largest one, or 0. Two of three steps follow it, the third
/// halves the interval of exponents.
template <class Holds, class Guess>
double largest(const Holds& holds, const Guess& guess) {
    const double least = std::log2(least_change), most = std::log2(most_change), tight = std::log2(most_tight);
    double low = least, high = most, next = -24, down = 8;
    bool is_low = false, is_high = false;
    for (int step = 0;; ++step) {
        const bool yes = holds(std::exp2(next));
        (yes ? low : high) = next, (yes ? is_low : is_high) = true;
        if (is_low && high - low <= (low >= tight ? 1.0 : 1.0 / 16)) return std::exp2(low);
        if (yes && low >= most) return most_change;
        if (!yes && high <= least) return 0;
        const double guessed = yes ? next + 1.0 / 16 : std::log2(guess()) - 1.0 / 64;
        const bool guesses = step % 3 != 2 && guessed > low && guessed < high && is_high && low < tight;
        if (guesses) next = guessed;
        else if (!is_high) next = low < tight ? tight : most;
        else if (!is_low) next = std::max(high - down, least), down *= 2;
        else next = (low + high) / 2;
    }
}
/// The same without a guess, and to a factor of 2^(1/16) everywhere.
template <class Holds>
double largest(const Holds& holds) {
    if (!holds(least_change)) return 0;
    if (holds(most_change)) return most_change;
    double low = std::log2(least_change), high = std::log2(most_change);
    while (high - low > 1.0 / 16) {
        const double middle = (low + high) / 2;
        (holds(std::exp2(middle)) ? low : high) = middle;
    }
    return std::exp2(low);
}

/// Side of m on which the answers of all rays that hit lie. −1 and +1 prove that no answer is m, even where some rays
/// miss.
template <class S>
std::optional<int> side_if_any(const S& span, const Near& m, const RangeOfSpan<Near>* range,
                               intersect::Convention convention) {
    return side_of<Near>(span, m, Length::parameter, range, convention);
}
std::optional<int> side_if_any(const FlatSpan<Near>& span, const Near& m, const RangeOfSpan<Near>*,
                               intersect::Convention) {
    return side_of_fraction(span.at, span.d2, m, Length::parameter);
}
/// The largest entry lies after m if any entry does, and before m if all do.
std::optional<int> side_if_any(const SlabSpan<Near>& span, const Near& m, const RangeOfSpan<Near>* range,
                               intersect::Convention convention) {
    const bool is_exit =
        !(span.entry[0].n > Near(0) || span.entry[1].n > Near(0) || span.entry[2].n > Near(0)).is_yes();
    if (range || is_exit) return side_of<Near>(span, m, Length::parameter, range, convention);
    bool all_before = true;
    for (const Fraction<Near>& entry : span.entry) {
        const auto side = side_of_fraction(entry, span.d2, m, Length::parameter);
        if (side == 1) return 1;
        all_before = all_before && side == -1;
    }
    return all_before ? std::optional(-1) : std::nullopt;
}

}  // namespace

namespace {

template <class E>
std::optional<SpanDecision> met_exactly(const QuarticSpan<E>& span, const RangeOfSpan<E>* range,
                                        intersect::Convention asked) {
    const RootHit<E> met = root_hit(span, range, asked);
    if (met.hit.is_unknown()) return std::nullopt;
    const auto maximum = Turns(span).maximum();
    if (met.hit.is_no() || met.root < 0 || !maximum) return SpanDecision{met.hit, met.at};
    const auto order = met.roots.order(met.root, E(*maximum));
    return SpanDecision{met.hit, met.at,
                        !order       ? TorusPass::either
                        : *order < 0 ? TorusPass::first
                                     : TorusPass::second};
}
template <class E, class S>
std::optional<SpanDecision> met_exactly(const S& span, const RangeOfSpan<E>* range, intersect::Convention asked) {
    const Enclosed<E> found = enclose<E>(span, range, asked);
    return found.hit.is_unknown() ? std::nullopt : std::optional(SpanDecision{found.hit, found.at});
}

/// True if P has the sign of `value` for all problems from t₀ = n₀/m on, or from t₀ to t₁ = n₁/m: its value and slope
/// at t₀ are given, times m² and m. For either sign of a. P(t) ≥ P(t₀) − s²/a if its slope at t₀ is −2s, s > 0 and a >
/// 0. Between t₀ and t₁, where P is given to be positive, it lies above its tangent at t₀, or, for a < 0, above its
/// chord.
bool stays_positive(const QuadraticAt<Near>& at, const Near& a, const Near& step) {
    const double s = std::max(0.0, -at.half_slope.lowest()), value = at.value.lowest();
    if (s * s * (1 + 0x1p-40) < a.lowest() * value) return true;
    return Near(at.value + (at.half_slope + at.half_slope) * step).lowest() > 0;
}

/// True if no line of all problems meets the part of a quadric between the planes. Where the line runs along its axis,
/// or past a rim, several signs are open that no problem has at once.
bool misses(const CappedSpan<Near>& s) {
    if (!s.crossed.is_yes() || !(s.at_entry.value.lowest() > 0 && s.at_exit.value.lowest() > 0)) return false;
    const Near step = s.exit.n - s.entry.n;
    const QuadraticAt<Near> back{s.at_exit.value, -s.at_exit.half_slope};
    return stays_positive(s.at_entry, s.side.a, step) || stays_positive(back, s.side.a, step);
}
/// A tube is missed too by lines that run inside of it from plane to plane.
bool misses(const WallSpan<Near>& s) {
    const auto& [entry, exit] = std::pair(s.primitive.at_entry.value, s.primitive.at_exit.value);
    return s.primitive.crossed.is_yes() && entry.highest() < 0 && exit.highest() < 0 ? true : misses(s.primitive);
}
/// A ball is missed where the discriminant is below zero.
bool misses(const QuadraticSpan<Near>& s) { return s.q.highest() < 0; }
bool misses(const auto&) { return false; }

/// A primitive that is the union of others is missed by lines that miss each of them.
bool misses_parts(const Ray<Near>& ray, const Primitive<Near>& primitive) {
    return visit_shape(primitive, [&]<template <class> class Of>() {
        return in_object_space<Of>(ray, primitive, [](const Of<Near>& shape, const Ray<Near>& its) {
            bool all = false;
            if constexpr (requires { each_part(shape, [](const auto&) {}); }) {
                all = true;
                each_part(shape, [&](const auto& part) { all = all && misses(part.span(its)); });
            }
            return all;
        });
    });
}

/// The meeting of a ray and a primitive, and whether it changes near the ray.
class Decision {
public:
    Decision(const MarginQuestion& asked, CountedChange turned) : asked_(asked), turned_(turned), met_(met_after({})) {}

    /// True if all problems within ε meet the same, with a proof.
    bool holds(double epsilon, const Change& from = {}) {
        ++all_holds;
        const bool same = met_ && asked_.of_all_within(
                                      epsilon,
                                      [&](const auto&... problem) {
                                          return cases_.all([&] { return outcome_of(problem...); },
                                                            epsilon < most_tight && from.by == 0 ? 24 : 8);
                                      },
                                      from);
        if (!same) blamed_ = cases_.contradiction(), tried_ = epsilon;
        return same;
    }
    /// An ε for which all signs are known that the last `holds` could not prove, to first order; 0 where it has none.
    [[nodiscard]] double guess() const {
        double most = 0;
        for (const auto& [x, sign] : blamed_)
            if (x.hi() * sign <= 0) most = std::max(most, std::fabs(x.hi()) / x.deviation());
        return tried_ * std::min(most, 1.0);
    }

    /// Looks for a problem within ε that meets something else, under deviations that change the signs that the last
    /// `holds` could not prove: from the problem itself, then from problems ε away, where what is 0 to first order at
    /// the problem itself is seen to grow.
    std::optional<Change> turns(double epsilon) {
        if (!met_) return std::nullopt;
        asked_exactly_ = 0;
        for (std::uint64_t start = 0; start < most_starts; ++start) {
            Change from;
            if (start > 0) {
                from = {random_deviations(start), epsilon / 2};
                static_cast<void>(holds(epsilon, from));
            }
            for (int step = 0; step < most_steps; ++step) {
                std::vector<Near::Deviations> found = deviations_to_culprits();
                if (found.empty()) break;
                for (const Near::Deviations& deviations : found)
                    if (is_other({deviations, epsilon})) return Change{deviations, epsilon};
                if (asked_exactly_ >= most_asked) return std::nullopt;
                from = {found.front(), epsilon / 2};
                static_cast<void>(holds(epsilon, from));
            }
        }
        return std::nullopt;
    }

private:
    static constexpr std::uint64_t most_starts = 2;
    static constexpr int most_steps = 2, most_asked = 16;

    [[nodiscard]] std::optional<SpanDecision> met_after(const Change& change) const {
        return asked_.of_changed(change,
                                 [&](const auto& ray, const auto& primitive, const auto* range, const auto& words) {
                                     return with_span(ray, primitive, [&]<class Span>(const Span& span) {
                                         return met_exactly(span, range, asked_of_span<Span>(words));
                                     });
                                 });
    }
    bool is_other(const Change& change) {
        ++asked_exactly_;
        ++all_exact;
        const auto met = met_after(change);
        return met && !met->is_same(*met_, turned_);
    }
    /// Known, and the same.
    std::pair<bool, bool> outcome_of(const Ray<Near>& ray, const Primitive<Near>& primitive,
                                     const RangeOfSpan<Near>* range, intersect::Convention words) {
        if (met_->hit.is_no() && misses_parts(ray, primitive)) return {true, true};
        const SpanDecision met = with_span(ray, primitive, [&]<class Span>(const Span& span) {
            const intersect::Convention asked = asked_of_span<Span>(words);
            if constexpr (std::is_same_v<Span, QuarticSpan<Near>>) {
                return QuarticCases(span, range, asked, turned_, cases_).find();
            } else {
                if (met_->hit.is_no() && misses(span)) return SpanDecision{Tri::no};
                Near::signs_only = true;
                const Enclosed<Near> found = enclose<Near>(span, range, asked);
                Near::signs_only = false;
                return SpanDecision{found.hit, found.at};
            }
        });
        return {!met.hit.is_unknown(), met.is_same(*met_, turned_)};
    }
    /// Deviations under which the signs of `blamed_` change: each by itself, then all together.
    [[nodiscard]] std::vector<Near::Deviations> deviations_to_culprits() const {
        std::vector<Near::Deviations> found;
        Near::Deviations together{};
        for (const auto& [x, sign] : blamed_) {
            const double middle = x.hi(), about_0 = x.deviation() / 4;
            for (const int wanted : {-1, 1}) {
                if (sign * wanted < 0 || middle * wanted > about_0) continue;
                Near::Deviations deviations = x.steepest();
                for (std::size_t i = 0; i < deviations.size(); ++i)
                    deviations[i] *= wanted, together[i] += deviations[i];
                found.push_back(deviations);
            }
        }
        if (found.size() > 1) {
            for (double& x : together) x /= static_cast<double>(found.size());
            found.push_back(together);
        }
        return found;
    }
    [[nodiscard]] Near::Deviations random_deviations(std::uint64_t seed) const {
        Near::Deviations deviations{};
        std::uint64_t bits = seed * 0x9e3779b97f4a7c15U;
        for (std::size_t i = 0; i < asked_.count(); ++i) {
            bits ^= bits >> 29, bits *= 0xbf58476d1ce4e5b9U;
            deviations[i] = ((bits >> 40 & 1) != 0 ? 1 : -1) * asked_.share();
        }
        return deviations;
    }

    const MarginQuestion& asked_;
    CountedChange turned_;
    Cases cases_;
    std::optional<SpanDecision> met_;
    std::vector<Cases::Sign> blamed_;
    double tried_ = 0;
    int asked_exactly_ = 0;
};

}  // namespace

Margin margin_of(const Ray<double>& ray, const Primitive<double>& primitive, CountedChange turned, Perturbed perturbed,
                 intersect::Convention convention, Range<double> range) {
    if (!is_proper(ray) || !is_proper(primitive)) return {0, 0};
    const MarginQuestion asked(ray, primitive, perturbed, convention, range);
    Decision decision(asked, turned);
    const double proved =
        largest([&](double epsilon) { return decision.holds(epsilon); }, [&] { return decision.guess(); });
    if (proved >= most_tight) return {proved, HUGE_VAL};
    const double within = std::max(2 * proved, 2 * least_change);
    static_cast<void>(decision.holds(within));
    const auto change = decision.turns(within);
    return change ? Margin{proved, within, asked.amounts(*change)} : Margin{proved, HUGE_VAL};
}

std::optional<bool> is_turned_within(double epsilon, const Ray<double>& ray, const Primitive<double>& primitive,
                                     CountedChange turned, Perturbed perturbed, intersect::Convention convention,
                                     Range<double> range) {
    if (!is_proper(ray) || !is_proper(primitive)) return std::nullopt;
    const MarginQuestion asked(ray, primitive, perturbed, convention, range);
    Decision decision(asked, turned);
    if (decision.holds(epsilon)) return false;
    return decision.turns(epsilon) ? std::optional(true) : std::nullopt;
}

namespace {

/// How far a ray's line passes a ball around a primitive, relative to all lengths: (distance − R)/(|o| + |c| + R). A
/// change by ε moves that distance by at most 8 ε of these: the origin by |o|, the line by twice the way to the ball,
/// the centre of the primitive by |c| + R, and its points by turning it, by 3 R.
double gap(const Ray<double>& ray, const Primitive<double>& primitive) {
    if (primitive.placed || !has_bounding_box(primitive.shape)) return 0;
    const auto ball = ball_around(primitive);
    const Vec<double> from = ray.origin - ball.centre;
    const double away = length(cross(from, ray.direction)) / length(ray.direction);
    return (away * (1 - 0x1p-40) - ball.radius) / (length(ray.origin) + length(ball.centre) + ball.radius);
}

}  // namespace

std::size_t nearest_decision(const Ray<double>& ray, const scene::rays::PrimitiveList<double>& primitives,
                             intersect::Convention convention, Range<double> range) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < primitives.size(); ++i) order.emplace_back(gap(ray, primitives[i]), i);
    std::ranges::sort(order);
    double least = HUGE_VAL;
    std::size_t nearest = 0;
    for (const auto& [away, i] : order) {
        if (away > 8 * least) break;
        const Primitive<double> primitive = primitives[i];
        if (!is_proper(ray) || !is_proper(primitive)) continue;
        const MarginQuestion asked(ray, primitive, Perturbed::componentwise, convention, range);
        Decision decision(asked, CountedChange::root);
        if (least < HUGE_VAL && decision.holds(least)) continue;
        const double margin =
            largest([&](double epsilon) { return decision.holds(epsilon); }, [&] { return decision.guess(); });
        if (margin < least) least = margin, nearest = i;
    }
    return nearest;
}

namespace {

/// True if the point at t lies on the surface of no problem within the errors, for a surface of degree four. Where two
/// roots of the quartic are near each other, small changes of a problem change its sign, but not that of the distance
/// from the surface.
bool is_off_quartic(const Ray<Near>& ray, const Primitive<Near>& primitive, const Near& t) {
    return visit_shape(primitive, [&]<template <class> class Of>() {
        using Span = decltype(std::declval<const Of<Near>&>().span(ray));
        if constexpr (!std::same_as<Span, QuarticSpan<Near>>) return false;
        else {
            const Near away = in_object_space<Of>(ray, primitive, [&](const Of<Near>& shape, const Ray<Near>& its) {
                return shape.distance(its.origin + t * its.direction);
            });
            return away.lowest() > 0 || away.highest() < 0;
        }
    });
}

}  // namespace

double decision_margin(const Ray<double>& ray, const Primitive<double>& primitive, CountedChange turned,
                       Perturbed perturbed, intersect::Convention convention, Range<double> range) {
    const Margin margin = margin_of(ray, primitive, turned, perturbed, convention, range);
    return margin.is_tight() ? margin.proved : missing;
}

double backward_error(const Ray<double>& ray, const Primitive<double>& primitive, double t, Perturbed perturbed,
                      intersect::Convention convention, Range<double> range) {
    if (!(t > 0)) return std::nan("");
    if (!is_proper(ray) || !is_proper(primitive) || std::isinf(t)) return 0;
    const MarginQuestion asked(ray, primitive, perturbed, convention, range);
    const Near there(asked.in_time(t));
    return largest([&](double epsilon) {
        return asked.of_all_within(epsilon, [&](const auto& r, const auto& s, const auto* within, const auto& words) {
            const auto side =
                with_span(r, s, [&](const auto& span) { return side_if_any(span, there, within, words); });
            return (side && *side != 0) || is_off_quartic(r, s, there);
        });
    });
}

}  // namespace lostbits::measure::stability
