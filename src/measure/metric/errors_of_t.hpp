// How far an answer is from t*, and which part of that the inputs, the formula and its rounding have: functions of a
// sample that has both, for the table of metrics.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

double ulp_error(const Sample& s);
double lost(const Sample& s);
double correct(const Sample& s);
double herbie(const Sample& s);
double absolute(const Sample& s);
double relative(const Sample& s);
/// |t − t*| |d|, to a relative error of 2^-50; of a form that asks for directions of length one d is what it got, and
/// is of that length to the rounding of the format.
double distance_error(const Sample& s);
double input_error(const Sample& s);
double model_error(const Sample& s);
double rounding_error(const Sample& s);

}  // namespace lostbits::measure::metric
