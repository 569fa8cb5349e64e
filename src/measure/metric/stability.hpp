// How far a form's answers are from those of a problem nearby: backward errors, and decisions that hang by little.
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

}  // namespace lostbits::measure::metric
