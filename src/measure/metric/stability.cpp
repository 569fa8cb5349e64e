// Metrics of the distance of an answer from that of a nearby problem, and of errors that are predicted without the
// exact answer.
#include <cmath>

#include "measure/metric/values.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::metric {

using truth::missing, truth::Perturbation, stability::CountedChange;

namespace {

double backward(const Sample& sample, Perturbation perturbation) {
    if (!sample.primitive || sample.march) return missing;
    return in_roundoffs(stability::backward_error(*sample.ray, *sample.primitive, sample.t, perturbation,
                                                  sample.convention, sample.range),
                        sample);
}

double backward_error(const Sample& sample) { return backward(sample, Perturbation::componentwise); }
double backward_error_normwise(const Sample& sample) { return backward(sample, Perturbation::normwise); }
double decision_margin(const Sample& sample) {
    if (!sample.primitive || sample.march) return missing;
    return in_roundoffs(stability::find_decision_margin(*sample.ray, *sample.primitive, CountedChange::root,
                                                        Perturbation::componentwise, sample.convention, sample.range),
                        sample);
}

double wrong_decision(const Sample& sample) {
    if (!sample.primitive || sample.march) return missing;
    if (!answer::is_wrong(sample.outcome)) return 0;
    const double u = std::ldexp(1.0, -sample.format->parameters.precision);
    const auto changes_within_u =
        stability::changes_within(u, *sample.ray, *sample.primitive, CountedChange::decision,
                                  Perturbation::componentwise, sample.convention, sample.range);
    return !changes_within_u ? 3 : *changes_within_u ? 1 : 2;
}

/// True if the attribution is that of t, and not of a decision that rounding changed.
bool explains_t(const Sample& sample) {
    return sample.attribution && !sample.march &&
           sample.attribution->attribution->subject == sample.attribution->tape->outputs.t;
}

double cestac_bits(const Sample& sample) {
    if (!explains_t(sample)) return missing;
    return stability::RandomRuns(*sample.attribution->tape).correct_bits(sample.format->parameters.precision);
}

double cestac_error(const Sample& sample) {
    if (!explains_t(sample)) return missing;
    const int precision = sample.format->parameters.precision;
    const stability::RandomRuns runs(*sample.attribution->tape);
    const double error = (runs.mean() - sample.t) + sample.attribution->attribution->error;
    return runs.correct_bits(precision) - (precision - truth::lost_bits(error / sample.attribution->ulp, precision));
}

double cestac_digit(const Sample& sample) {
    const double error = cestac_error(sample);
    if (std::isnan(error)) return missing;
    return error >= std::log2(10.0) ? 1 : 0;
}

double cestac_decision(const Sample& sample) {
    if (!sample.attribution || sample.march) return missing;
    const bool is_stable = stability::RandomRuns(*sample.attribution->tape).agree();
    return (is_stable ? 0 : 2) + (answer::is_wrong(sample.outcome) ? 1 : 0);
}

double statistical_ratio(const Sample& sample) {
    if (!explains_t(sample)) return missing;
    const double bound =
        stability::compute_statistical_bound(*sample.attribution->tape, *sample.attribution->attribution);
    const double error = std::fabs(sample.attribution->attribution->error);
    return error == 0 ? 0 : error / bound;
}

constexpr std::string_view wrong_decision_names[] = {"right", "within_u", "beyond_u", "unproved"};
constexpr std::string_view cestac_decision_names[] = {"stable_right", "stable_wrong", "unstable_right",
                                                      "unstable_wrong"};
constexpr std::string_view cestac_digit_names[] = {"kept", "overrated"};

constexpr Metric rows_of_stability[] = {
    table_row(
        {"backward_error", "u", "stability.backward"},
        "least relative change of every number of the ray and the primitive, as the format holds them, for which t "
        "is exactly the answer, in u = 2^-p: a proved lower bound, exact to first order",
        backward_error, {.ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"backward_error_normwise", "u", "stability.normwise"},
              "backward_error for changes of each vector relative to its length: components that are 0 change too",
              backward_error_normwise, {.ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row(
        {"decision_margin", "u", "stability.margin"},
        "least relative change of every number of the ray and the primitive, as the format holds them, that changes "
        "hit or miss or the root, in u = 2^-p: a proved lower bound; below 2^-10 the least change is at most twice "
        "as large, and the margin is missing where that is not proved; for the primitive that the form hits, else "
        "the one truly hit, else the ray's own or, of several, the one that the ray misses most narrowly",
        decision_margin, {.ramp = Ramp::magnitude, .low = 0x1p-1, .domain = MetricDomain::every}),
    table_row(
        {"wrong_decision", "", "stability.wrong"},
        "tells whether a false hit, a false miss or a wrong primitive is proved to be wrong for all problems within "
        "u of every number (beyond_u), or to be right for one of them (within_u); unproved: neither",
        wrong_decision, {.ramp = Ramp::categories, .domain = MetricDomain::every, .categories = wrong_decision_names}),
    table_row({"cestac_bits", "bits", "prediction.cestac"},
              "correct bits of the mean t of three runs with random rounding, as CESTAC predicts them from the three "
              "runs: log2(sqrt(3) |mean|/(4.303 s)), from 0 to p",
              cestac_bits, {.needs = needs_attribution, .ramp = Ramp::kept}),
    table_row(
        {"cestac_error", "bits", "prediction.cestac_error"},
        "cestac_bits minus the bits that the mean of the three runs shares with the form without rounding: above 0, "
        "CESTAC predicts more bits than are correct",
        cestac_error, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-4, .high = 0x1p+6}),
    table_row({"cestac_digit", "", "prediction.cestac_digit"},
              "tells whether cestac_error is a decimal digit, log2(10) bits, or more (overrated); statistics of "
              "cestac_error are of its magnitude, so they include predictions that are too low",
              cestac_digit,
              {.needs = needs_attribution,
               .ramp = Ramp::categories,
               .domain = MetricDomain::blamed,
               .categories = cestac_digit_names}),
    table_row({"cestac_decision", "", "prediction.cestac_decision"},
              "tells whether three runs with random rounding all hit or all miss (stable), and whether the form's "
              "decision is right",
              cestac_decision,
              {.needs = needs_attribution,
               .ramp = Ramp::categories,
               .domain = MetricDomain::blamed,
               .categories = cestac_decision_names}),
    table_row(
        {"statistical_ratio", "1", "prediction.statistical"},
        "|t - t of the form without rounding| over the root of the sum of the squares of the largest error of each "
        "operation: independent rounding errors would exceed x with probability 2 exp(-x^2/2) at most",
        statistical_ratio, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-6, .high = 0x1p+2})};

}  // namespace

std::span<const Metric> metrics_of_stability() { return rows_of_stability; }

}  // namespace lostbits::measure::metric
