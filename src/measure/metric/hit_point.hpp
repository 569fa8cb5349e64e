// Where a form says that the ray meets the solid, and how far that is off the surface.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// P = o + t·d as the format computes it: a product and a sum, each rounded.
Vec<double> hit_point(const Sample& s);

/// (|P − G| − r)/r; of a box the largest of lo − P and P − hi over the axes, in longest sides.
double residual(const Sample& s);

}  // namespace lostbits::measure::metric
