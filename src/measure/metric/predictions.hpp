// How often what is predicted of an error without the exact answer is right.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

double cestac_bits(const Sample& s);
double cestac_error(const Sample& s);
double cestac_decision(const Sample& s);
double statistical_ratio(const Sample& s);

inline constexpr std::string_view cestac_decision_names[] = {"stable_right", "stable_wrong", "unstable_right",
                                                             "unstable_wrong"};

inline constexpr Metric metrics_of_predictions[] = {
    {.name = "cestac_bits",
     .unit = "bits",
     .layer = "prediction.cestac",
     .meaning = "correct bits of the mean t of three runs with random rounding, as they predict them: log2(sqrt(3) "
                "|mean|/(4.303 s)), from 0 to p (CESTAC)",
     .needs = needs_attribution,
     .ramp = Ramp::kept,
     .value = cestac_bits},
    {.name = "cestac_error",
     .unit = "bits",
     .layer = "prediction.cestac_error",
     .meaning = "cestac_bits less the bits that the mean of the three runs has in common with the form without "
                "rounding: above 0 more is promised than there is",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .high = 0x1p+6,
     .value = cestac_error},
    {.name = "cestac_decision",
     .layer = "prediction.cestac_decision",
     .meaning = "whether three runs with random rounding all hit or all miss (stable), and whether the form's decision "
                "is right",
     .needs = needs_attribution,
     .ramp = Ramp::categories,
     .value = cestac_decision,
     .over = Over::blamed,
     .categories = cestac_decision_names},
    {.name = "statistical_ratio",
     .unit = "1",
     .layer = "prediction.statistical",
     .meaning = "|t - the form without rounding| over the root of the sum of the squares of what each operation can "
                "cost: rounding errors that were independent would exceed x with probability 2 exp(-x^2/2) at most",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-6,
     .high = 0x1p+2,
     .value = statistical_ratio}};

}  // namespace lostbits::measure::metric
