// What a march that looked for the hit did.
#pragma once

#include <algorithm>

#include "measure/metric/metrics.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::metric {

inline double iterations(const Sample& s) { return s.march ? s.march->iterations : truth::missing; }
inline double stop(const Sample& s) { return s.march ? static_cast<double>(s.march->stop) : truth::missing; }
inline double overshoot(const Sample& s) { return s.march ? std::max(0.0, -s.march->deepest) : truth::missing; }
inline double least_field(const Sample& s) { return s.march ? s.march->least : truth::missing; }

inline constexpr Metric metrics_of_marches[]{
    {.name = "iterations",
     .unit = "samples",
     .layer = "march.iterations",
     .meaning = "samples of the field that the march took",
     .ramp = Ramp::magnitude,
     .low = 1,
     .high = 0x1p+8,
     .by_default = true,
     .value = iterations,
     .over = Over::marches},
    {.name = "stop",
     .layer = "march.stop",
     .meaning = "why the march ended; stagnated: at the step cap, where the next step would lead nowhere (t + d == t)",
     .ramp = Ramp::categories,
     .by_default = true,
     .value = stop,
     .over = Over::marches,
     .categories = intersect::stop_names},
    {.name = "least_field",
     .unit = "length",
     .layer = "march.least_field",
     .meaning = "smallest |field| that the march sampled",
     .ramp = Ramp::magnitude,
     .high = 0x1p+4,
     .by_default = true,
     .value = least_field,
     .over = Over::marches},
    {.name = "overshoot",
     .unit = "length",
     .layer = "march.overshoot",
     .meaning = "how deep inside the march sampled the field: max(0, -field); from outside it is 0 in exact arithmetic",
     .ramp = Ramp::magnitude,
     .high = 0x1p+4,
     .value = overshoot,
     .over = Over::marches}};

}  // namespace lostbits::measure::metric
