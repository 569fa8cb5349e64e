// Compares the answers of a form's operations without any rounding with the truth.
#include <algorithm>
#include <cmath>

#include "measure/metric/statistics.hpp"
#include "measure/repair/repair.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::repair {

namespace {

double direction_length(const std::vector<double>& inputs) { return std::hypot(inputs[3], inputs[4], inputs[5]); }

/// Rays with directions divided by their length, in double.
std::vector<std::vector<double>> normalise_directions(std::vector<std::vector<double>> rays) {
    for (auto& inputs : rays) {
        const double length = direction_length(inputs);
        for (std::size_t k = 3; k < 6; ++k) inputs[k] /= length;
    }
    return rays;
}

/// Error of t in ulps of the correct t, which may be 0.
double error_in_ulps(double t, double correct_t, const FloatFormat& format) {
    if (correct_t == 0) return t == 0 ? 0 : HUGE_VAL;
    const auto ulp = ulp_exponent(format, std::ilogb(std::fabs(correct_t)));
    return std::ldexp(t - correct_t, -static_cast<int>(ulp));
}

}  // namespace

FormQuality RaySample::measure_exact_quality(const Tape& tape, const std::vector<std::vector<double>>& inputs) const {
    FormQuality quality;
    metric::Distribution lost;
    std::uint64_t false_hit_count = 0;
    const FloatFormat& format = tested_form_.format.parameters;

    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const auto& [decision, correct_t, range] = correct_answers_[i];
        if (decision == truth::Truth::Decision::unresolved) continue;
        limit_.stop.check();
        const Tape exact = run_with_inputs(tape, inputs[i], false);
        if (divides_by_zero(exact)) continue;

        const double t = exact[exact.outputs.t].value;
        const bool hit = exact[exact.outputs.hit].value != 0 && !range.is_before(t) && !range.is_after(t);
        const bool should_hit = !std::isnan(correct_t);

        // A wrong decision has no error of t.
        ++quality.ray_count;
        quality.true_hit_count += should_hit ? 1 : 0;
        if (hit != should_hit) {
            ++quality.wrong_count;
            false_hit_count += hit ? 1 : 0;
        } else if (hit) {
            lost.add(truth::lost_bits(error_in_ulps(t, correct_t, format), format.precision));
        }
    }

    quality.kept_bits = format.precision - lost.quantile(requirement_.quantile);
    const bool are_mostly_false_hits = 2 * false_hit_count > quality.wrong_count;
    if (quality.wrong_count > 0)
        quality.main_fault = are_mostly_false_hits ? answer::Outcome::false_hit : answer::Outcome::false_miss;
    quality.main_fault_count = are_mostly_false_hits ? false_hit_count : quality.wrong_count - false_hit_count;
    return quality;
}

Obstruction RaySample::compare_without_rounding(const Tape& tape) const {
    Obstruction obstruction{.exact = measure_exact_quality(tape, inputs_)};
    if (tested_form_.form->info->direction != intersect::Direction::unit) return obstruction;
    for (const auto& inputs : inputs_)
        obstruction.largest_length_error =
            std::max(obstruction.largest_length_error, std::fabs(direction_length(inputs) - 1));
    obstruction.with_unit_directions = measure_exact_quality(tape, normalise_directions(inputs_));
    return obstruction;
}

}  // namespace lostbits::measure::repair
