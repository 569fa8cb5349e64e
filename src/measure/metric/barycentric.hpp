// Of what vertices a form makes the point that it hits.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// The largest |x − x*| of the weights x of a, b and c that the form computes, in u = 2^-p: a weight of a point within
/// is at most 1, whatever the size of the triangle. x* is of the ray and the triangle as the form received them.
/// Infinite where one is no number; missing of a form that names none, or whose operations cannot be asked.
double barycentric_error(const Sample& s);
/// |x + y + z − 1|, in u, of a form that computes all three.
double barycentric_sum(const Sample& s);

inline constexpr Metric metrics_of_weights[] = {
    {.name = "barycentric_error",
     .unit = "u",
     .layer = "weights.error",
     .meaning = "of a triangle: the largest error of the barycentric coordinates (u, v) that the form computes, "
                "|u - u*| over 2^-p",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .value = barycentric_error},
    {.name = "barycentric_sum",
     .unit = "u",
     .layer = "weights.sum",
     .meaning = "of a triangle: |u + v + w - 1| over 2^-p, of a form that computes all three barycentric coordinates",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .high = 0x1p+4,
     .value = barycentric_sum}};

}  // namespace lostbits::measure::metric
