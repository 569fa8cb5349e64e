// The functions that compute metrics from a sample, and the lists of metrics that other files add to the table.
#pragma once

#include <cmath>
#include <span>

#include "measure/metric/metrics.hpp"
#include "shapes/bounding_box.hpp"

namespace lostbits::measure::metric {

/// Converts x to units of u = 2^-p.
inline double in_roundoffs(double x, const Sample& sample) {
    return std::ldexp(x, sample.format->parameters.precision);
}

// Metrics that compare t with t* (errors_of_t.cpp).
double ulp_error(const Sample& sample);
double lost_bits(const Sample& sample);
double correct_bits(const Sample& sample);
double herbie(const Sample& sample);
double absolute_error(const Sample& sample);
double relative_error(const Sample& sample);
/// |t − t*| |d|, computed with a relative error of at most 2^-50. For a form that takes unit directions, d is the
/// normalised direction that it received; its length differs from 1 only by rounding to the format.
double distance_error(const Sample& sample);
double input_error(const Sample& sample);
double model_error(const Sample& sample);
double rounding_error(const Sample& sample);

// Metrics of the hit point (hit_point.cpp).
/// (|P − G| − r)/r. For a box, the largest of lo − P and P − hi over the axes, in units of the longest side.
double residual(const Sample& sample);
/// Angle between the normals at the hit point and at the true one, for a primitive without a matrix.
double normal_error(const Sample& sample);
/// Largest component of P − P*, in units of (1 + max|P|) u.
double point_error(const Sample& sample);
/// Largest relative error of a component of the hit point after projection onto its sphere, in u; missing for boxes.
double projected_error(const Sample& sample);
/// Smallest padding of tmax, in u, with which the slab test finds a box that is truly hit: (tmin − tmax)/(tmax u), or 0
/// if the test finds it without padding. Missing for other primitives. For a form behind a bounding box, the padding of
/// that box, whatever the primitive.
double padding(const Sample& sample);
/// Same padding for the slabs of one box, in binary32, whether or not the ray hits it.
double padding(const Ray<float>& ray, const BoundingBox<float>& box);

std::span<const Metric> metrics_of_t();
std::span<const Metric> metrics_of_stability();
std::span<const Metric> metrics_of_rays();
std::span<const Metric> metrics_of_barycentrics();

}  // namespace lostbits::measure::metric
