// How far an answer is from t*, and which part of that the inputs, the formula and its rounding have: functions of a
// sample that has both, for the table of metrics.
#pragma once

#include <string_view>

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
double error_at_zero(const Sample& s);
double derivative_error(const Sample& s);
double root(const Sample& s);

/// In the order of the values of `root`.
inline constexpr std::string_view root_names[] = {"no_hit", "true", "wrong"};

/// Where an ulp of t* says nothing, or not enough.
inline constexpr Metric metrics_of_t[] = {
    {.name = "error_at_zero",
     .unit = "u",
     .layer = "err.at_zero",
     .meaning = "of a hit at t* = 0, where no ulp measures: |t| |d| over u times the largest number of the origin and "
                "of the points and lengths of the solid",
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .value = error_at_zero},
    {.name = "root",
     .layer = "err.root",
     .meaning = "whether a correct hit has the t of another crossing of the same solid: to a quarter of what lies "
                "between that and the true one (wrong); no_hit: of no correct hit",
     .ramp = Ramp::categories,
     .value = root,
     .over = Over::every,
     .categories = root_names},
    {.name = "derivative_error",
     .unit = "u",
     .layer = "err.derivative",
     .meaning = "dt/dx of every number of origin, direction, points and lengths, as the form yields them by forward "
                "differentiation in the format: the largest error of one, over the largest of its vector; of a form "
                "for unit directions without those of the direction, of a solid under no matrix",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-1,
     .value = derivative_error}};

}  // namespace lostbits::measure::metric
