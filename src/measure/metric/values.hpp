// What the rows of the table measure: functions of a sample, and the lists of rows that belong together.
#pragma once

#include <cmath>
#include <span>

#include "measure/metric/metrics.hpp"
#include "shapes/hull.hpp"

namespace lostbits::measure::metric {

/// In u = 2^-p.
inline double in_roundoffs(double x, const Sample& s) { return std::ldexp(x, s.format->parameters.precision); }

// Of a sample with t and t* (errors_of_t.cpp).
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

// Of the hit point (hit_point.cpp).
/// (|P − G| − r)/r; of a box the largest of lo − P and P − hi over the axes, in longest sides.
double residual(const Sample& s);
/// The angle between the normal of the solid at the hit point and at the true one, of a solid under no matrix.
double normal_error(const Sample& s);
/// The largest component of P − P*, in (1 + max|P|) u.
double point_error(const Sample& s);
/// The largest relative error of a component of the hit point put back onto its sphere, in u; missing for boxes.
double projected_error(const Sample& s);
/// By how many u a far plane's t must grow for the slabs of a box that is truly hit to overlap; missing for others.
/// Behind a box it is that of the box, whatever the solid.
double padding(const Sample& s);
/// The same of the slabs of one box, in binary32, whether or not the ray hits it.
double padding(const Ray<float>& ray, const Hull<float>& box);

std::span<const Metric> metrics_of_t();
std::span<const Metric> metrics_of_stability();
std::span<const Metric> metrics_of_rays();
std::span<const Metric> metrics_of_weights();

}  // namespace lostbits::measure::metric
