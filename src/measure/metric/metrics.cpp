#include "measure/metric/metrics.hpp"

#include "measure/answer/against.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "measure/metric/errors_of_rays.hpp"
#include "measure/metric/errors_of_t.hpp"
#include "measure/metric/hit_point.hpp"
#include "measure/metric/march.hpp"
#include "measure/metric/published_bounds.hpp"
#include "measure/metric/stability.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

double condition_number(const Sample& s) { return s.condition; }
double inherent(const Sample& s) { return truth::inherent_bits(s.reach, *s.truth, s.format->shape); }
double normwise(const Sample& s) { return truth::inherent_bits(s.reach_normwise, *s.truth, s.format->shape); }
double excess(const Sample& s) { return truth::excess_bits(s.t, *s.truth, s.format->shape, s.reach); }

double culprit(const Sample& s) { return s.blame ? s.blame->culprit : missing; }
double cancelled(const Sample& s) { return s.blame ? blame::worst_cancellation(*s.blame->attribution) : missing; }

template <blame::Counterfactual blame::Counterfactuals::*run>
double counterfactual(const Sample& s) {
    if (!s.blame || !s.blame->culprit_alone) return missing;
    const blame::Counterfactual& c = (*s.blame->culprit_alone).*run;
    return c.hit ? c.error / s.blame->ulp : missing;
}

double worst_step(const Sample& s) {
    if (!s.steps) return missing;
    const auto worst = s.steps->worst();
    return worst ? static_cast<double>(*worst) + 1 : 0;
}

double lost_to(const Sample& s) { return s.levels ? static_cast<double>(s.levels->lost_to) : missing; }
double bound_ratio(const Sample& s) { return bound_over(s, rounding_error(s)); }

constexpr unsigned split = needs_own_truth | needs_self;

constexpr Metric table[] = {
    {.name = "lost_bits",
     .unit = "bits",
     .layer = "bits.lost",
     .meaning = "clamp(log2(2|ulp_error|), 0, p): significand bits that are wrong",
     .by_default = true,
     .value = lost,
     .in_columns = InColumns::lost_bits},
    {.name = "correct_bits",
     .unit = "bits",
     .layer = "bits.correct",
     .meaning = "p - lost_bits",
     .ramp = Ramp::kept,
     .value = correct,
     .in_columns = InColumns::correct_bits},
    {.name = "herbie_bits",
     .unit = "bits",
     .layer = "bits.herbie",
     .meaning = "log2(1 + |ordinal(t) - ordinal(RN(t*))|): Herbie's and FPBench's measure",
     .needs = needs_rounded_truth,
     .value = herbie},
    {.name = "ulp_error",
     .unit = "ulp",
     .layer = "err.ulp",
     .meaning = "(t - t*)/ulp(t*), signed, against the unrounded truth; 0 where t is infinite as t* is when rounded",
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .by_default = true,
     .value = ulp_error,
     .in_columns = InColumns::ulp_error},
    {.name = "relative_error",
     .unit = "1",
     .layer = "err.relative",
     .meaning = "|t - t*|/|t*|",
     .ramp = Ramp::magnitude,
     .high = 1,
     .by_default = true,
     .value = relative,
     .in_columns = InColumns::relative_error},
    {.name = "absolute_error",
     .unit = "t",
     .layer = "err.absolute",
     .meaning = "|t - t*|, in units of t",
     .ramp = Ramp::magnitude,
     .high = 0x1p+10,
     .value = absolute,
     .in_columns = InColumns::absolute_error},
    {.name = "distance_error",
     .unit = "length",
     .layer = "err.distance",
     .meaning =
         "|t - t*| |d|: how far the hit point is from the true one, along the ray, in the scene's unit of length",
     .ramp = Ramp::magnitude,
     .high = 0x1p+10,
     .value = distance_error},
    {.name = "residual",
     .unit = "size",
     .layer = "err.residual",
     .meaning = "(|P - G| - r)/r for P = o + t d computed in the format: how far the hit point is off the surface; of "
                "a box: the largest of lo - P and P - hi over the axes, in longest sides; negative inside; statistics "
                "are of the magnitude",
     .ramp = Ramp::magnitude,
     .high = 1,
     .by_default = true,
     .value = residual,
     .in_columns = InColumns::residual},
    {.name = "normal_error",
     .unit = "radian",
     .layer = "err.normal",
     .meaning = "the angle between the normal of the solid at the hit point, both computed in the format, and the one "
                "where the ray truly meets it; of a solid under no matrix, in float and double",
     .ramp = Ramp::magnitude,
     .high = 0x1p+1,
     .value = normal_error},
    {.name = "input_error",
     .unit = "ulp",
     .layer = "split.input",
     .meaning = "(t* of the inputs as the format holds them - t*)/ulp(t*)",
     .needs = needs_own_truth,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = input_error},
    {.name = "model_error",
     .unit = "ulp",
     .layer = "split.model",
     .meaning = "(the form without rounding - t* of its inputs)/ulp(t*)",
     .needs = split,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = model_error},
    {.name = "rounding_error",
     .unit = "ulp",
     .layer = "split.rounding",
     .meaning = "(t - the form without rounding)/ulp(t*); the three sum to ulp_error",
     .needs = needs_self,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = rounding_error},
    {.name = "condition",
     .unit = "1",
     .layer = "condition.kappa",
     .meaning = "kappa = sum |x_i dt/dx_i| / |t| over all inputs of the ray and the sphere it truly hits",
     .needs = needs_condition,
     .ramp = Ramp::magnitude,
     .low = 1,
     .high = 0x1p+30,
     .value = condition_number},
    {.name = "inherent_bits",
     .unit = "bits",
     .layer = "condition.inherent",
     .meaning = "bits that half an ulp in each input alone can cost: lost bits of the most that t can move, in ulp(t*)",
     .needs = needs_reach,
     .value = inherent},
    {.name = "inherent_bits_normwise",
     .unit = "bits",
     .layer = "condition.normwise",
     .meaning =
         "the same of errors in the length of each vector v by u|v|, of a radius r by u r: no component keeps its 0",
     .needs = needs_reach_normwise,
     .value = normwise},
    {.name = "excess_bits",
     .unit = "bits",
     .layer = "condition.excess",
     .meaning = "lost_bits beyond inherent_bits: what the formula itself loses; where inherent_bits is p, log2 of "
                "|t - t*| over what half an ulp in each input can move t",
     .needs = needs_reach,
     .value = excess},
    {.name = "point_error",
     .unit = "u",
     .layer = "bound.point",
     .meaning = "largest component of P - P*, P = o + t d as the format computes it and P* = o + t* d exactly, over "
                "(1 + max|P|) u: renderers move the next ray's origin by so many u",
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .value = point_error},
    {.name = "projected_error",
     .unit = "u",
     .layer = "bound.projected",
     .meaning = "of a sphere: P put back onto the surface as P r/|P| about the centre, in the format: largest relative "
                "error of a component against the exact P r/|P| of the same P, in u",
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .high = 0x1p+4,
     .value = projected_error},
    {.name = "padding",
     .unit = "u",
     .layer = "bound.padding",
     .meaning =
         "of a box that is truly hit: by how many u tmax must grow for slabs to see it, (tmin/tmax - 1)/u with "
         "tmin and tmax of box.signs in the format; 0 where it is seen as it is. Of a form behind a box (FORM^BOX), of "
         "that box, and of the one that needs most",
     .needs = needs_levels,
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .high = 0x1p+4,
     .value = padding,
     .over = Over::every},
    {.name = "bound",
     .unit = "ulp",
     .layer = "bound.size",
     .meaning =
         "what the form itself knows of its error: a running bound on rounding, computed in the format beside t, "
         "over ulp(t*); infinite where it knows nothing",
     .needs = needs_bound,
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .value = bound},
    {.name = "bound_ratio",
     .unit = "1",
     .layer = "bound.ratio",
     .meaning = "bound / |rounding_error|: how many times too wide; never below 1",
     .needs = needs_bound | needs_self,
     .ramp = Ramp::magnitude,
     .low = 1,
     .high = 0x1p+20,
     .value = bound_ratio},
    {.name = "decision",
     .layer = "bound.decision",
     .meaning = "whether the form's own running bounds prove its hit or miss, for the solid that it hits, or truly is "
                "hit, or else the first",
     .needs = needs_bound,
     .ramp = Ramp::categories,
     .value = decision,
     .over = Over::every,
     .categories = intersect::decision_names},
    {.name = "arithmetic",
     .layer = "bound.arithmetic",
     .meaning = "the arithmetic in which a form that filters settled the ray, with the solid that it hits, or truly is "
                "hit, or else the first: its own, the next wider one of one word, two words, exact sums",
     .needs = needs_way,
     .ramp = Ramp::categories,
     .value = arithmetic,
     .over = Over::every,
     .categories = intersect::way_names},
    {.name = "worst_step",
     .layer = "space.step",
     .meaning = "of the steps into the space of a solid under a matrix and back, the one to which most of the error of "
                "t is assigned, or the first that turns the decision: each step in turn rounded, those after it exact",
     .needs = needs_steps,
     .ramp = Ramp::categories,
     .value = worst_step,
     .over = Over::every,
     .categories = answer::step_categories},
    {.name = "lost_to",
     .layer = "hierarchy.lost_to",
     .meaning = "of a form behind boxes (FORM^BOX) and rays that truly hit: what the hit is lost to: the box in the "
                "world, the way into the space of the solid, the box there, or the form; nothing where it is found",
     .needs = needs_levels,
     .ramp = Ramp::categories,
     .value = lost_to,
     .over = Over::every,
     .categories = answer::level_names},
    {.name = "end_margin",
     .unit = "ulp",
     .layer = "hierarchy.end",
     .meaning = "of a form behind boxes (FORM^BOX): how many ulps of t another hit, found before, must lie behind this "
                "one for it to be found still: the least k for which the boxes are hit by a ray that ends at t + k "
                "ulp(t); 0 for one at the same t",
     .needs = needs_end_margin,
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .high = 0x1p+6,
     .value = [](const Sample& s) { return s.end_margin; }},
    {.name = "cancellation",
     .unit = "bits",
     .layer = "culprit.cancellation",
     .meaning = "bits of the largest cancellation on the way to t whose operands were already wrong",
     .needs = needs_attribution,
     .value = cancelled},
    {.name = "culprit",
     .layer = "culprit.operation",
     .meaning = "the operation to which most of the error of t, or of a decision that rounding changed, is assigned",
     .needs = needs_attribution,
     .ramp = Ramp::categories,
     .value = culprit,
     .over = Over::blamed,
     .by_run = true},
    {.name = "without_culprit",
     .unit = "ulp",
     .layer = "culprit.without",
     .meaning = "what rounding makes of t if the culprit alone does not round, in ulps of t without rounding",
     .needs = needs_tape,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = counterfactual<&blame::Counterfactuals::mended>},
    {.name = "culprit_alone",
     .unit = "ulp",
     .layer = "culprit.alone",
     .meaning = "what rounding makes of t if the culprit alone rounds, in ulps of t without rounding",
     .needs = needs_tape,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = counterfactual<&blame::Counterfactuals::alone>},
    {.name = "against",
     .layer = "against.class",
     .meaning = "whether the form of --against decides the same, and has the same t; alone_hits: the other one misses",
     .ramp = Ramp::categories,
     .over = Over::pairs,
     .categories = answer::against_names},
    {.name = "apart",
     .unit = "ulp",
     .layer = "against.apart",
     .meaning = "(t - t of the form of --against) / ulp of that, where both hit",
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .over = Over::pairs},
};

template <std::size_t... n>
constexpr auto joined(const Metric (&... lists)[n]) {
    std::array<Metric, (n + ...)> rows{};
    auto end = rows.begin();
    ((end = std::ranges::copy(lists, end).out), ...);
    return rows;
}

/// A file of metrics is a word here.
constexpr auto all = joined(table, metrics_of_t, metrics_of_stability, metrics_of_predictions, metrics_of_marches,
                            metrics_of_rays, metrics_of_weights);

}  // namespace

std::span<const Metric> metrics() { return all; }

const Metric* find_metric(std::string_view name) {
    const auto found = std::ranges::find(all, name, &Metric::name);
    return found == std::end(all) ? nullptr : found;
}

std::size_t place_of(const std::vector<const Metric*>& metrics, std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(metrics, name, &Metric::name) - metrics.begin());
}

}  // namespace lostbits::measure::metric
