// How far a form's answers are from those of a problem nearby, and what is foretold of errors without the exact answer.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

double backward_error(const Sample& s);
double backward_error_normwise(const Sample& s);
double decision_margin(const Sample& s);
double wrong_decision(const Sample& s);

inline constexpr std::string_view wrong_decision_names[] = {"right", "within_u", "beyond_u"};

inline constexpr Metric metrics_of_stability[] = {
    {.name = "backward_error",
     .unit = "u",
     .layer = "stability.backward",
     .meaning = "the least relative change of every number of the ray and the solid, as the format holds them, for "
                "which t is exactly the answer, in u = 2^-p: a proved lower bound, to first order the least one",
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = backward_error},
    {.name = "backward_error_normwise",
     .unit = "u",
     .layer = "stability.normwise",
     .meaning = "the same of changes of each vector by a part of its length: no component keeps its 0",
     .ramp = Ramp::magnitude,
     .low = 0x1p-4,
     .value = backward_error_normwise},
    {.name = "decision_margin",
     .unit = "u",
     .layer = "stability.margin",
     .meaning = "the least relative change of every number of the ray and the solid, as the format holds them, that "
                "turns hit or miss or which root is met, in u = 2^-p: a proved lower bound; of the solid that the form "
                "hits, or truly is hit, or else the first",
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .value = decision_margin,
     .over = Over::every},
    {.name = "wrong_decision",
     .layer = "stability.wrong",
     .meaning = "whether a false hit, a false miss or a wrong solid is proved to be wrong for all problems within u of "
                "every number (beyond_u), or may be right for one of them (within_u)",
     .ramp = Ramp::categories,
     .value = wrong_decision,
     .over = Over::every,
     .categories = wrong_decision_names}};

double cestac_bits(const Sample& s);
double cestac_error(const Sample& s);
double cestac_digit(const Sample& s);
double cestac_decision(const Sample& s);
double statistical_ratio(const Sample& s);

inline constexpr std::string_view cestac_decision_names[] = {"stable_right", "stable_wrong", "unstable_right",
                                                             "unstable_wrong"};

inline constexpr std::string_view cestac_digit_names[] = {"kept", "overrated"};

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
    {.name = "cestac_digit",
     .layer = "prediction.cestac_digit",
     .meaning = "whether cestac_error is a decimal digit, log2(10) bits, or more (overrated); statistics of "
                "cestac_error are of its size, and promises that are too modest are among them",
     .needs = needs_attribution,
     .ramp = Ramp::categories,
     .value = cestac_digit,
     .over = Over::blamed,
     .categories = cestac_digit_names},
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
