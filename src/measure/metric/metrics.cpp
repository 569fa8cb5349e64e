#include "measure/metric/metrics.hpp"

#include "measure/answer/against.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "measure/metric/values.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

double condition_number(const Sample& sample) { return sample.condition; }
double inherent(const Sample& sample) {
    return truth::inherent_bits(sample.reach, *sample.true_t, sample.format->parameters);
}
double normwise(const Sample& sample) {
    return truth::inherent_bits(sample.reach_normwise, *sample.true_t, sample.format->parameters);
}
double excess(const Sample& sample) {
    return truth::excess_bits(sample.t, *sample.true_t, sample.format->parameters, sample.reach);
}

double culprit(const Sample& sample) { return sample.attribution ? sample.attribution->culprit : missing; }
double cancelled(const Sample& sample) {
    return sample.attribution ? attribution::worst_cancellation(*sample.attribution->attribution) : missing;
}

template <attribution::Counterfactual attribution::Counterfactuals::*run>
double counterfactual(const Sample& sample) {
    if (!sample.attribution || !sample.attribution->culprit_alone) return missing;
    const attribution::Counterfactual& c = (*sample.attribution->culprit_alone).*run;
    return c.hit ? c.error / sample.attribution->ulp : missing;
}

double worst_step(const Sample& sample) {
    if (!sample.steps) return missing;
    const auto worst = sample.steps->worst();
    return worst ? static_cast<double>(*worst) + 1 : 0;
}

/// Form's own bound on the rounding error of t, in ulps of the format at t*; infinite if the form has none.
double bound(const Sample& sample) {
    if (!sample.bounded_answer) return missing;
    if (!(sample.bounded_answer->error < HUGE_VAL)) return HUGE_VAL;
    return std::ldexp(sample.bounded_answer->error,
                      -static_cast<int>(ulp_exponent(sample.format->parameters, sample.true_t->floor_log2())));
}

double bound_ratio(const Sample& sample) {
    const double error = rounding_error(sample), size = bound(sample);
    return size == 0 && error == 0 ? 1 : size / std::fabs(error);
}

double decision(const Sample& sample) {
    return sample.bounded_answer ? (sample.bounded_answer->proved ? 0 : 1) : missing;
}

double arithmetic(const Sample& sample) {
    return sample.deciding_arithmetic ? static_cast<double>(*sample.deciding_arithmetic) : missing;
}

double iterations(const Sample& sample) { return sample.march ? sample.march->iterations : missing; }
double stop(const Sample& sample) { return sample.march ? static_cast<double>(sample.march->stop) : missing; }
double overshoot(const Sample& sample) { return sample.march ? std::max(0.0, -sample.march->deepest) : missing; }
double least_field(const Sample& sample) { return sample.march ? sample.march->least : missing; }

double lost_to(const Sample& sample) { return sample.levels ? static_cast<double>(sample.levels->lost_to) : missing; }

constexpr unsigned split_needs = needs_stored_truth | needs_unrounded;

constexpr Metric table[] = {
    table_row({"lost_bits", "bits", "bits.lost"}, "clamp(log2(2|ulp_error|), 0, p): significand bits that are wrong",
              lost_bits, {.is_default = true, .column_kernel = ColumnKernel::lost_bits}),
    table_row({"correct_bits", "bits", "bits.correct"}, "p - lost_bits", correct_bits,
              {.ramp = Ramp::kept, .column_kernel = ColumnKernel::correct_bits}),
    table_row({"herbie_bits", "bits", "bits.herbie"},
              "log2(1 + |ordinal(t) - ordinal(RN(t*))|): Herbie's and FPBench's measure", herbie,
              {.needs = needs_rounded_truth}),
    table_row(
        {"ulp_error", "ulp", "err.ulp"},
        "(t - t*)/ulp(t*), signed, compared with the unrounded truth; 0 where t is infinite and t* rounds to infinity",
        ulp_error,
        {.ramp = Ramp::magnitude, .low = 0x1p-4, .is_default = true, .column_kernel = ColumnKernel::ulp_error}),
    table_row({"relative_error", "1", "err.relative"}, "|t - t*|/|t*|", relative_error,
              {.ramp = Ramp::magnitude, .high = 1, .is_default = true, .column_kernel = ColumnKernel::relative_error}),
    table_row({"absolute_error", "t", "err.absolute"}, "|t - t*|, in units of t", absolute_error,
              {.ramp = Ramp::magnitude, .high = 0x1p+10, .column_kernel = ColumnKernel::absolute_error}),
    table_row({"distance_error", "length", "err.distance"},
              "|t - t*| |d|: how far the hit point is from the true one, along the ray, in the scene's unit of length",
              distance_error, {.ramp = Ramp::magnitude, .high = 0x1p+10}),
    table_row(
        {"residual", "size", "err.residual"},
        "distance of P = o + t d, computed in the format, from the surface, over the size of the primitive; negative "
        "inside; for a sphere: (|P - G| - r)/r; for a box: the largest of lo - P and P - hi over the axes, over the "
        "longest side; for a plane in units of length; statistics are of the magnitude",
        residual, {.ramp = Ramp::magnitude, .high = 1, .is_default = true, .column_kernel = ColumnKernel::residual}),
    table_row(
        {"normal_error", "radian", "err.normal"},
        "angle between the normal at the hit point, both computed in the format, and the normal where the ray truly "
        "hits; for a primitive without a matrix, in float and double",
        normal_error, {.ramp = Ramp::magnitude, .high = 0x1p+1}),
    table_row({"input_error", "ulp", "split.input"}, "(t* for the inputs as the format holds them - t*)/ulp(t*)",
              input_error, {.needs = needs_stored_truth, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"model_error", "ulp", "split.model"},
              "(t of the form without rounding - t* for the same "
              "inputs)/ulp(t*)",
              model_error, {.needs = split_needs, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"rounding_error", "ulp", "split.rounding"},
              "(t - t of the form without rounding)/ulp(t*); ulp_error is the sum of input_error, model_error and "
              "rounding_error",
              rounding_error, {.needs = needs_unrounded, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"condition", "1", "condition.kappa"},
              "kappa = sum |x_i dt/dx_i| / |t| over all inputs of the ray and the primitive it truly hits",
              condition_number, {.needs = needs_condition, .ramp = Ramp::magnitude, .low = 1, .high = 0x1p+30}),
    table_row(
        {"inherent_bits", "bits", "condition.inherent"},
        "bits that an error of half an ulp in each input alone can cost: lost bits of the largest change of t, in "
        "ulp(t*)",
        inherent, {.needs = needs_reach}),
    table_row(
        {"inherent_bits_normwise", "bits", "condition.normwise"},
        "inherent_bits for errors of length u|v| in each vector v, and of u r in a radius r: components that are 0 "
        "change too",
        normwise, {.needs = needs_reach_normwise}),
    table_row({"excess_bits", "bits", "condition.excess"},
              "lost_bits beyond inherent_bits: the loss of the formula itself; where inherent_bits is all p bits: "
              "max(0, log2(|t - t*| / bound)), with the bound that inherent_bits is computed from",
              excess, {.needs = needs_reach}),
    table_row({"point_error", "u", "bound.point"},
              "largest component of P - P*, P = o + t d as the format computes it and P* = o + t* d exactly, over (1 + "
              "max|P|) u: renderers move the next ray's origin by a number of these units",
              point_error, {.ramp = Ramp::magnitude, .low = 0x1p-2}),
    table_row({"projected_error", "u", "bound.projected"},
              "for a sphere: P projected onto the surface as P r/|P| about the centre, in the format; largest relative "
              "error of a component, compared with the exact P r/|P| of the same P, in u",
              projected_error, {.ramp = Ramp::magnitude, .low = 0x1p-2, .high = 0x1p+4}),
    table_row(
        {"padding", "u", "bound.padding"},
        "for a box that is truly hit: number of u by which tmax must grow for the slab test to find it, (tmin/tmax - "
        "1)/u with tmin and tmax of box.signs in the format; 0 if the box is found without padding. For a form behind "
        "a box (FORM^BOX): the padding of its bounding box; for several boxes the largest padding",
        padding,
        {.needs = needs_levels, .ramp = Ramp::magnitude, .low = 0x1p-2, .high = 0x1p+4, .domain = MetricDomain::every}),
    table_row(
        {"bound", "ulp", "bound.size"},
        "the form's own bound of its error: a running bound on rounding, computed in the format along with t, over "
        "ulp(t*); infinite if the form can give no bound",
        bound, {.needs = needs_bound, .ramp = Ramp::magnitude, .low = 0x1p-1}),
    table_row({"bound_ratio", "1", "bound.ratio"},
              "bound / |rounding_error|: the factor by which the bound is too wide; never below 1", bound_ratio,
              {.needs = needs_bound | needs_unrounded, .ramp = Ramp::magnitude, .low = 1, .high = 0x1p+20}),
    table_row(
        {"decision", "", "bound.decision"},
        "tells whether the form's own running bounds prove its hit or miss; for the primitive that the form hits, "
        "else the one truly hit, else the ray's own or the first of several",
        decision,
        {.needs = needs_bound,
         .ramp = Ramp::categories,
         .domain = MetricDomain::every,
         .categories = intersect::decision_names}),
    table_row(
        {"arithmetic", "", "bound.arithmetic"},
        "arithmetic in which a form that filters settled the ray: its own, the next wider one of one word, two "
        "words, or exact sums; for the primitive that the form hits, else the one truly hit, else the ray's own or "
        "the first of several",
        arithmetic,
        {.needs = needs_deciding_arithmetic,
         .ramp = Ramp::categories,
         .domain = MetricDomain::every,
         .categories = intersect::arithmetic_names}),
    table_row({"worst_step", "", "space.step"},
              "for a primitive with a transform: the step to object space or back to which most of the error of t is "
              "assigned, or the first one that changes the decision; each step in turn is rounded, with the steps "
              "after it exact",
              worst_step,
              {.needs = needs_steps,
               .ramp = Ramp::categories,
               .domain = MetricDomain::every,
               .categories = answer::step_categories}),
    table_row(
        {"lost_to", "", "hierarchy.lost_to"},
        "for a form behind boxes (FORM^BOX), on rays that truly hit: the stage that loses the hit: the box in the "
        "world, the transform to object space, the box there, or the form; nothing where the hit is found",
        lost_to,
        {.needs = needs_levels,
         .ramp = Ramp::categories,
         .domain = MetricDomain::every,
         .categories = answer::level_names}),
    table_row(
        {"end_margin", "ulp", "hierarchy.end"},
        "for a form behind boxes (FORM^BOX): the least k for which a ray that ends at t + k ulp(t) hits the boxes; "
        "a hit found earlier must lie k ulps behind this hit, so that this hit is still found; 0 if the same t is "
        "enough",
        [](const Sample& sample) { return sample.end_margin; },
        {.needs = needs_end_margin, .ramp = Ramp::magnitude, .low = 0x1p-1, .high = 0x1p+6}),
    table_row({"cancellation", "bits", "culprit.cancellation"},
              "bits of the largest cancellation on the way to t whose operands were already wrong", cancelled,
              {.needs = needs_attribution}),
    table_row({"culprit", "", "culprit.operation"},
              "operation to which most of the error of t, or of a decision that rounding changed, is assigned", culprit,
              {.needs = needs_attribution,
               .ramp = Ramp::categories,
               .domain = MetricDomain::blamed,
               .depends_on_forms = true}),
    table_row({"without_culprit", "ulp", "culprit.without"},
              "rounding error of t if the culprit alone does not round, in ulps of t without rounding",
              counterfactual<&attribution::Counterfactuals::only_exact>,
              {.needs = needs_tape, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"culprit_alone", "ulp", "culprit.alone"},
              "rounding error of t if the culprit alone rounds, in ulps of t without rounding",
              counterfactual<&attribution::Counterfactuals::only_rounded>,
              {.needs = needs_tape, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"against", "", "against.class"},
              "tells whether the form of --against makes the same decision with the same t; alone_hits: the form of "
              "--against misses",
              nullptr, {.ramp = Ramp::categories, .domain = MetricDomain::pairs, .categories = answer::against_names}),
    table_row({"apart", "ulp", "against.apart"},
              "(t - t of the form of --against) / ulp(t of that form), where both hit", nullptr,
              {.ramp = Ramp::magnitude, .low = 0x1p-1, .domain = MetricDomain::pairs})};

/// Metrics of the march that found the hit or missed it.
constexpr Metric metrics_of_marches[] = {
    table_row({"iterations", "samples", "march.iterations"}, "samples of the field that the march took", iterations,
              {.ramp = Ramp::magnitude, .low = 1, .high = 0x1p+8, .is_default = true, .domain = MetricDomain::marches}),
    table_row(
        {"stop", "", "march.stop"},
        "reason why the march ended; stagnated: at the step limit, and the next step would not change t (t + d == t)",
        stop,
        {.ramp = Ramp::categories,
         .is_default = true,
         .domain = MetricDomain::marches,
         .categories = intersect::stop_names}),
    table_row({"least_field", "length", "march.least_field"}, "smallest |field| that the march sampled", least_field,
              {.ramp = Ramp::magnitude, .high = 0x1p+4, .is_default = true, .domain = MetricDomain::marches}),
    table_row(
        {"overshoot", "length", "march.overshoot"},
        "largest depth inside at which the march sampled the field: max(0, -field); from outside it is 0 in exact "
        "arithmetic",
        overshoot, {.ramp = Ramp::magnitude, .high = 0x1p+4, .domain = MetricDomain::marches})};

/// Joins lists of metrics into one.
std::vector<Metric> join_lists(std::initializer_list<std::span<const Metric>> lists) {
    std::vector<Metric> all;
    for (const auto list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

}  // namespace

std::span<const Metric> metrics() {
    static const std::vector<Metric> all =
        join_lists({table, metrics_of_t(), metrics_of_stability(), metrics_of_marches, metrics_of_rays(),
                    metrics_of_barycentrics()});
    return all;
}

const Metric* find_metric(std::string_view name) {
    const auto found = std::ranges::find(metrics(), name, &Metric::name);
    return found == metrics().end() ? nullptr : &*found;
}

std::size_t index_of(const std::vector<const Metric*>& metrics, std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(metrics, name, &Metric::name) - metrics.begin());
}

}  // namespace lostbits::measure::metric
