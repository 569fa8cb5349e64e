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

constexpr double min_change = 0x1p-90, max_change = 0.5;

/// Largest ε for which `holds` is proved, to a factor of 2^(1/16), or of 2 from `max_tight_margin` on, and at most
/// `max_change`; 0 if not even `min_change` is proved. A proof for ε also proves every smaller ε. After each ε that
/// is not proved, `guess()` estimates the largest ε, or returns 0. Two of three steps use the estimate; the third
/// halves the interval of exponents.
template <class Holds, class Guess>
double find_largest_epsilon(const Holds& holds, const Guess& guess) {
    const double least = std::log2(min_change), most = std::log2(max_change), tight = std::log2(max_tight_margin);
    double low = least, high = most, exponent = -24, step_down = 8;
    bool is_low = false, is_high = false;
    for (int step = 0;; ++step) {
        const bool is_proved = holds(std::exp2(exponent));
        (is_proved ? low : high) = exponent, (is_proved ? is_low : is_high) = true;
        if (is_low && high - low <= (low >= tight ? 1.0 : 1.0 / 16)) return std::exp2(low);
        if (is_proved && low >= most) return max_change;
        if (!is_proved && high <= least) return 0;
        const double guess_exponent = is_proved ? exponent + 1.0 / 16 : std::log2(guess()) - 1.0 / 64;
        const bool uses_guess =
            step % 3 != 2 && guess_exponent > low && guess_exponent < high && is_high && low < tight;
        if (uses_guess) exponent = guess_exponent;
        else if (!is_high) exponent = low < tight ? tight : most;
        else if (!is_low) exponent = std::max(high - step_down, least), step_down *= 2;
        else exponent = (low + high) / 2;
    }
}
/// Largest ε without a guess, and to a factor of 2^(1/16) everywhere.
template <class Holds>
double find_largest_epsilon(const Holds& holds) {
    if (!holds(min_change)) return 0;
    if (holds(max_change)) return max_change;
    double low = std::log2(min_change), high = std::log2(max_change);
    while (high - low > 1.0 / 16) {
        const double middle = (low + high) / 2;
        (holds(std::exp2(middle)) ? low : high) = middle;
    }
    return std::exp2(low);
}

/// Side of m on which the answers of all rays that hit lie; rays may miss. −1 and +1 prove that no answer is m.
template <class S>
std::optional<int> compare_all_hits(const S& span, const Near& m, const SpanRange<Near>* range,
                                    intersect::Convention convention) {
    return compare_hit<Near>(span, m, Length::parameter, range, convention);
}
std::optional<int> compare_all_hits(const FlatSpan<Near>& span, const Near& m, const SpanRange<Near>*,
                                    intersect::Convention) {
    return compare_fraction(span.at, span.d2, m, Length::parameter);
}
/// The largest entry lies after m if any entry does, and before m if all entries do.
std::optional<int> compare_all_hits(const SlabSpan<Near>& span, const Near& m, const SpanRange<Near>* range,
                                    intersect::Convention convention) {
    const bool is_exit =
        !(span.entry[0].n > Near(0) || span.entry[1].n > Near(0) || span.entry[2].n > Near(0)).is_yes();
    if (range || is_exit) return compare_hit<Near>(span, m, Length::parameter, range, convention);
    bool all_before = true;
    for (const Fraction<Near>& entry : span.entry) {
        const auto order = compare_fraction(entry, span.d2, m, Length::parameter);
        if (order == 1) return 1;
        all_before = all_before && order == -1;
    }
    return all_before ? std::optional(-1) : std::nullopt;
}

}  // namespace

namespace {

template <class E>
std::optional<SpanDecision> decide_exactly(const QuarticSpan<E>& span, const SpanRange<E>* range,
                                           intersect::Convention convention) {
    const RootHit<E> found_root = find_root_hit(span, range, convention);
    if (found_root.hit.is_unknown()) return std::nullopt;
    const auto maximum = CriticalPoints(span).maximum();
    if (found_root.hit.is_no() || found_root.root < 0 || !maximum)
        return SpanDecision{found_root.hit, found_root.crossing};
    const auto order = found_root.roots.order(found_root.root, E(*maximum));
    return SpanDecision{found_root.hit, found_root.crossing,
                        !order       ? TorusPass::unspecified
                        : *order < 0 ? TorusPass::first
                                     : TorusPass::second};
}
template <class E, class S>
std::optional<SpanDecision> decide_exactly(const S& span, const SpanRange<E>* range, intersect::Convention convention) {
    const EnclosedHit<E> enclosed = enclose<E>(span, range, convention);
    return enclosed.hit.is_unknown() ? std::nullopt : std::optional(SpanDecision{enclosed.hit, enclosed.crossing});
}

/// Proves that P is positive for all problems from t₀ = n₀/m on, or from t₀ to t₁ = n₁/m, for either sign of a. `start`
/// has the value and half the slope of P at t₀, times m² and m. P(t) ≥ P(t₀) − s²/a if the slope at t₀ is −2s, s > 0
/// and a > 0. Between t₀ and t₁, P lies above its tangent at t₀, or, for a < 0 and P(t₁) > 0, above its chord.
bool stays_positive(const QuadraticAt<Near>& start, const Near& a, const Near& step) {
    const double s = std::max(0.0, -start.half_slope.lowest()), value = start.value.lowest();
    if (s * s * (1 + 0x1p-40) < a.lowest() * value) return true;
    return Near(start.value + (start.half_slope + start.half_slope) * step).lowest() > 0;
}

/// True if no line of all problems meets the part of a quadric between the planes. If the line runs along the axis, or
/// past a rim, the enclosures leave several signs open that no single problem has together.
bool misses(const CappedSpan<Near>& span) {
    if (!span.crosses_planes.is_yes() ||
        !(span.at_planes_entry.value.lowest() > 0 && span.at_planes_exit.value.lowest() > 0))
        return false;
    const Near step = span.planes_exit.n - span.planes_entry.n;
    const QuadraticAt<Near> back{span.at_planes_exit.value, -span.at_planes_exit.half_slope};
    return stays_positive(span.at_planes_entry, span.side.a, step) || stays_positive(back, span.side.a, step);
}
/// Lines that run inside a tube from plane to plane miss it, too.
bool misses(const WallSpan<Near>& span) {
    const auto& [at_entry, at_exit] =
        std::pair(span.primitive.at_planes_entry.value, span.primitive.at_planes_exit.value);
    const bool runs_inside = at_entry.highest() < 0 && at_exit.highest() < 0;
    return (span.primitive.crosses_planes.is_yes() && runs_inside) || misses(span.primitive);
}
/// A line misses a ball if the discriminant is below zero.
bool misses(const QuadraticSpan<Near>& span) { return span.q.highest() < 0; }
bool misses(const auto&) { return false; }

/// True if every line of all problems misses each of the parts of a primitive that is a union.
bool misses_parts(const Ray<Near>& ray, const Primitive<Near>& primitive) {
    return visit_shape(primitive, [&]<template <class> class S>() {
        return visit_in_object_space<S>(ray, primitive, [](const S<Near>& shape, const Ray<Near>& object_ray) {
            bool misses_all = false;
            if constexpr (requires { for_each_part(shape, [](const auto&) {}); }) {
                misses_all = true;
                for_each_part(shape,
                              [&](const auto& part) { misses_all = misses_all && misses(part.span(object_ray)); });
            }
            return misses_all;
        });
    });
}

/// Decision of a ray and a primitive, and whether it changes near the ray.
class Decision {
public:
    Decision(const MarginQuestion& question, CountedChange counted)
        : question_(question), counted_(counted), decision_(decision_after({})) {}

    /// True if all problems within ε have the same decision, with a proof.
    bool holds(double epsilon, const InputChange& start = {}) {
        const bool is_same =
            decision_ && question_.holds_for_all_within(
                             epsilon,
                             [&](const auto&... problem) {
                                 return cases_.holds_in_all([&] { return outcome_of(problem...); },
                                                            epsilon < max_tight_margin && start.scale == 0 ? 24 : 8);
                             },
                             start);
        if (is_same) return true;
        open_signs_ = cases_.contradiction();
        tried_epsilon_ = epsilon;
        return false;
    }
    /// An ε at which, to first order, all signs are known that the last `holds` could not prove; 0 if no ε suffices.
    [[nodiscard]] double guess() const {
        double largest_ratio = 0;
        for (const auto& [x, sign] : open_signs_)
            if (x.hi() * sign <= 0) largest_ratio = std::max(largest_ratio, std::fabs(x.hi()) / x.deviation());
        return tried_epsilon_ * std::min(largest_ratio, 1.0);
    }

    /// Looks for a problem within ε with another decision, by deviations that change the signs that the last `holds`
    /// could not prove: from the problem itself, then from problems ε/2 away, where an effect that is 0 to first order
    /// at the problem itself shows.
    std::optional<InputChange> find_change(double epsilon) {
        if (!decision_) return std::nullopt;
        exact_count_ = 0;
        for (std::uint64_t start_index = 0; start_index < max_starts; ++start_index) {
            InputChange start;
            if (start_index > 0) {
                start = {random_deviations(start_index), epsilon / 2};
                static_cast<void>(holds(epsilon, start));
            }

            // Each step tries deviations that change the open signs, then starts half way along the first of them.
            for (int step = 0; step < max_steps; ++step) {
                std::vector<Near::Deviations> candidates = deviations_to_open_signs();
                if (candidates.empty()) break;
                for (const Near::Deviations& deviations : candidates)
                    if (changes_decision({deviations, epsilon})) return InputChange{deviations, epsilon};
                if (exact_count_ >= max_exact_steps) return std::nullopt;

                start = {candidates.front(), epsilon / 2};
                static_cast<void>(holds(epsilon, start));
            }
        }
        return std::nullopt;
    }

private:
    static constexpr std::uint64_t max_starts = 2;
    static constexpr int max_steps = 2, max_exact_steps = 16;

    [[nodiscard]] std::optional<SpanDecision> decision_after(const InputChange& change) const {
        return question_.result_after(
            change, [&](const auto& ray, const auto& primitive, const auto* range, const auto& convention) {
                return with_span(ray, primitive, [&]<class Span>(const Span& span) {
                    return decide_exactly(span, range, convention_for_span<Span>(convention));
                });
            });
    }
    bool changes_decision(const InputChange& change) {
        ++exact_count_;
        const auto changed = decision_after(change);
        return changed && !changed->is_same(*decision_, counted_);
    }
    /// Returns whether the decision is known, and whether it is that of the problem itself.
    std::pair<bool, bool> outcome_of(const Ray<Near>& ray, const Primitive<Near>& primitive,
                                     const SpanRange<Near>* range, intersect::Convention convention) {
        if (decision_->hit.is_no() && misses_parts(ray, primitive)) return {true, true};
        const SpanDecision decision = with_span(ray, primitive, [&]<class Span>(const Span& span) {
            const intersect::Convention span_convention = convention_for_span<Span>(convention);
            if constexpr (std::is_same_v<Span, QuarticSpan<Near>>) {
                return QuarticCases(span, range, span_convention, counted_, cases_).decide();
            } else {
                if (decision_->hit.is_no() && misses(span)) return SpanDecision{Tri::no};
                Near::computes_signs_only = true;
                const EnclosedHit<Near> enclosed = enclose<Near>(span, range, span_convention);
                Near::computes_signs_only = false;
                return SpanDecision{enclosed.hit, enclosed.crossing};
            }
        });
        return {!decision.hit.is_unknown(), decision.is_same(*decision_, counted_)};
    }
    /// Deviations that change the signs of `open_signs_`: one for each sign, then one for all of them together.
    [[nodiscard]] std::vector<Near::Deviations> deviations_to_open_signs() const {
        std::vector<Near::Deviations> candidates;
        Near::Deviations mean_deviations{};
        for (const auto& [x, sign] : open_signs_) {
            const double middle = x.hi(), threshold = x.deviation() / 4;
            for (const int wanted_sign : {-1, 1}) {
                if (sign * wanted_sign < 0 || middle * wanted_sign > threshold) continue;
                Near::Deviations deviations = x.steepest_deviations();
                for (std::size_t i = 0; i < deviations.size(); ++i) {
                    deviations[i] *= wanted_sign;
                    mean_deviations[i] += deviations[i];
                }
                candidates.push_back(deviations);
            }
        }
        if (candidates.size() > 1) {
            for (double& x : mean_deviations) x /= static_cast<double>(candidates.size());
            candidates.push_back(mean_deviations);
        }
        return candidates;
    }
    [[nodiscard]] Near::Deviations random_deviations(std::uint64_t seed) const {
        Near::Deviations deviations{};
        std::uint64_t state = seed * 0x9e3779b97f4a7c15U;
        for (std::size_t i = 0; i < question_.number_count(); ++i) {
            state ^= state >> 29, state *= 0xbf58476d1ce4e5b9U;
            deviations[i] = ((state >> 40 & 1) != 0 ? 1 : -1) * question_.largest_deviation();
        }
        return deviations;
    }

    const MarginQuestion& question_;
    CountedChange counted_;
    Cases cases_;
    std::optional<SpanDecision> decision_;
    std::vector<Cases::Sign> open_signs_;
    double tried_epsilon_ = 0;
    int exact_count_ = 0;
};

}  // namespace

Margin find_margin(const Ray<double>& ray, const Primitive<double>& primitive, CountedChange counted,
                   Perturbation perturbation, intersect::Convention convention, Range<double> range) {
    if (!is_valid(ray) || !is_valid(primitive)) return {0, 0};
    const MarginQuestion question(ray, primitive, perturbation, convention, range);
    Decision decision(question, counted);
    const double proved =
        find_largest_epsilon([&](double epsilon) { return decision.holds(epsilon); }, [&] { return decision.guess(); });
    if (proved >= max_tight_margin) return {proved, HUGE_VAL};
    const double epsilon = std::max(2 * proved, 2 * min_change);
    static_cast<void>(decision.holds(epsilon));
    const auto change = decision.find_change(epsilon);
    return change ? Margin{proved, epsilon, question.amounts(*change)} : Margin{proved, HUGE_VAL};
}

std::optional<bool> changes_within(double epsilon, const Ray<double>& ray, const Primitive<double>& primitive,
                                   CountedChange counted, Perturbation perturbation, intersect::Convention convention,
                                   Range<double> range) {
    if (!is_valid(ray) || !is_valid(primitive)) return std::nullopt;
    const MarginQuestion question(ray, primitive, perturbation, convention, range);
    Decision decision(question, counted);
    if (decision.holds(epsilon)) return false;
    return decision.find_change(epsilon) ? std::optional(true) : std::nullopt;
}

namespace {

/// Distance of a ray's line from a ball around a primitive, relative to all lengths: (distance − R)/(|o| + |c| + R). A
/// change by ε moves that distance by at most 8 ε of their sum: the origin by |o|, the line by twice the way to the
/// ball, the centre of the primitive by |c| + R, and its points by 3 R, because it turns.
double relative_gap(const Ray<double>& ray, const Primitive<double>& primitive) {
    if (primitive.transform || !has_bounding_box(primitive.shape)) return 0;
    const auto ball = ball_around(primitive);
    const Vec<double> from_centre = ray.origin - ball.centre;
    const double distance = length(cross(from_centre, ray.direction)) / length(ray.direction);
    return (distance * (1 - 0x1p-40) - ball.radius) / (length(ray.origin) + length(ball.centre) + ball.radius);
}

}  // namespace

std::size_t find_nearest_decision(const Ray<double>& ray, const scene::rays::PrimitiveList<double>& primitives,
                                  intersect::Convention convention, Range<double> range) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < primitives.size(); ++i) order.emplace_back(relative_gap(ray, primitives[i]), i);
    std::ranges::sort(order);
    double least = HUGE_VAL;
    std::size_t nearest = 0;
    for (const auto& [ray_gap, i] : order) {
        if (ray_gap > 8 * least) break;
        const Primitive<double> primitive = primitives[i];
        if (!is_valid(ray) || !is_valid(primitive)) continue;
        const MarginQuestion question(ray, primitive, Perturbation::componentwise, convention, range);
        Decision decision(question, CountedChange::root);
        if (least < HUGE_VAL && decision.holds(least)) continue;
        const double margin = find_largest_epsilon([&](double epsilon) { return decision.holds(epsilon); },
                                                   [&] { return decision.guess(); });
        if (margin < least) {
            least = margin;
            nearest = i;
        }
    }
    return nearest;
}

namespace {

/// True if, for a surface of degree four, the point at t is proved to lie off the surface for all problems within the
/// errors. If two roots of the quartic are near each other, small changes of a problem change the sign of the quartic,
/// but not that of the distance from the surface.
bool is_off_quartic(const Ray<Near>& ray, const Primitive<Near>& primitive, const Near& t) {
    return visit_shape(primitive, [&]<template <class> class S>() {
        using Span = decltype(std::declval<const S<Near>&>().span(ray));
        if constexpr (!std::same_as<Span, QuarticSpan<Near>>) return false;
        else {
            const Near distance =
                visit_in_object_space<S>(ray, primitive, [&](const S<Near>& shape, const Ray<Near>& object_ray) {
                    return shape.distance(object_ray.origin + t * object_ray.direction);
                });
            return distance.lowest() > 0 || distance.highest() < 0;
        }
    });
}

}  // namespace

double find_decision_margin(const Ray<double>& ray, const Primitive<double>& primitive, CountedChange counted,
                            Perturbation perturbation, intersect::Convention convention, Range<double> range) {
    const Margin margin = find_margin(ray, primitive, counted, perturbation, convention, range);
    return margin.is_tight() ? margin.proved : missing;
}

double backward_error(const Ray<double>& ray, const Primitive<double>& primitive, double t, Perturbation perturbation,
                      intersect::Convention convention, Range<double> range) {
    if (!(t > 0)) return std::nan("");
    if (!is_valid(ray) || !is_valid(primitive) || std::isinf(t)) return 0;
    const MarginQuestion question(ray, primitive, perturbation, convention, range);
    const Near enclosed_t(question.to_problem_units(t));
    return find_largest_epsilon([&](double epsilon) {
        return question.holds_for_all_within(epsilon, [&](const auto& enclosed_ray, const auto& enclosed_primitive,
                                                          const auto* span_range, const auto& span_convention) {
            const auto order = with_span(enclosed_ray, enclosed_primitive, [&](const auto& span) {
                return compare_all_hits(span, enclosed_t, span_range, span_convention);
            });
            return (order && *order != 0) || is_off_quartic(enclosed_ray, enclosed_primitive, enclosed_t);
        });
    });
}

}  // namespace lostbits::measure::stability
