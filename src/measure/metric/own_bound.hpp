// What a form says of its own answer, as metrics.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// The form's own bound on the rounding error of t, in ulps of the format at t*; infinite where it knows nothing.
double bound(const Sample& s);
/// The bound over the size of an error in the same ulps; 1 where both are zero.
double bound_over(const Sample& s, double error);
/// The place in `intersect::decision_names`.
double decision(const Sample& s);
/// The place in `intersect::way_names`.
double arithmetic(const Sample& s);

}  // namespace lostbits::measure::metric
