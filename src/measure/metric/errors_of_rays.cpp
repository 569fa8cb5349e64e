// Metrics of the ray that a form is given: its distance from the ideal ray.

#include <cmath>

#include "measure/metric/values.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

bool is_finite(const Vec<double>& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_zero(const Vec<double>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

Real largest(const Vec<Real>& v) { return max(max(Real(abs(v.x)), Real(abs(v.y))), Real(abs(v.z))); }

/// Lost bits of the largest component of the difference, which is measured in ulps of the largest component of the true
/// vector.
double vector_lost_bits(const Vec<Real>& given, const Vec<Real>& true_vector, const FloatFormat& format) {
    const Real size = largest(true_vector);
    long floor_log2 = format.emin;
    if (size != 0) {
        int exponent = 0;
        frexp(size, &exponent);
        floor_log2 = exponent - 1;
    }
    const Real ulps = ldexp(largest(given - true_vector), -static_cast<int>(ulp_exponent(format, floor_log2)));
    return truth::lost_bits(ulps.convert_to<double>(), format.precision);
}

Vec<Real> unit(const Vec<Real>& v) { return (1 / length(v)) * v; }

bool has_direction(const Sample& sample) { return is_finite(sample.ray->direction) && !is_zero(sample.ray->direction); }

// Errors are infinite, and lost bits are the precision p, if a component is NaN or infinite or a direction is zero.

double origin_error(const Sample& sample) {
    if (!sample.true_ray) return missing;
    if (!is_finite(sample.ray->origin)) return HUGE_VAL;
    return length(lift_vec<Real>(sample.ray->origin) - sample.true_ray->origin).convert_to<double>();
}

double origin_lost_bits(const Sample& sample) {
    if (!sample.true_ray) return missing;
    if (!is_finite(sample.ray->origin)) return sample.format->parameters.precision;
    return vector_lost_bits(lift_vec<Real>(sample.ray->origin), sample.true_ray->origin, sample.format->parameters);
}

/// Computed from the sine and the cosine, which is accurate near 0 and near a right angle.
double direction_error(const Sample& sample) {
    if (!sample.true_ray) return missing;
    if (!has_direction(sample)) return HUGE_VAL;
    const Vec<Real> d = lift_vec<Real>(sample.ray->direction), &true_d = sample.true_ray->direction;
    return atan2(length(cross(d, true_d)), dot(d, true_d)).convert_to<double>();
}

double direction_lost_bits(const Sample& sample) {
    if (!sample.true_ray) return missing;
    if (!has_direction(sample)) return sample.format->parameters.precision;
    return vector_lost_bits(unit(lift_vec<Real>(sample.ray->direction)), unit(sample.true_ray->direction),
                            sample.format->parameters);
}

/// |d/(d·f) − d*/(d*·f)| over the side of a pixel, both at distance 1 in front of the eye. f is the direction in which
/// the camera looks.
double pixel_error(const Sample& sample) {
    if (!sample.true_ray || !sample.frame) return missing;
    if (!has_direction(sample)) return HUGE_VAL;
    const Vec<Real> d = lift_vec<Real>(sample.ray->direction), &true_d = sample.true_ray->direction;
    const Vec<Real>& forward = sample.frame->forward;
    const Real depth = dot(d, forward);
    if (depth <= 0) return HUGE_VAL;
    const Real distance = length((1 / depth) * d - (1 / dot(true_d, forward)) * true_d);
    return Real(distance / sample.frame->pitch).convert_to<double>();
}

/// Metrics that are measured on every ray, whatever the form answers.
constexpr Metric rows_of_rays[] = {
    table_row({"origin_error", "length", "ray.origin"},
              "|o - o*|: distance between the origins of the ray that the form is given and of the ideal ray, in the "
              "scene's unit of length",
              origin_error,
              {.needs = needs_true_ray, .ramp = Ramp::magnitude, .high = 0x1p+10, .domain = MetricDomain::every}),
    table_row({"origin_lost_bits", "bits", "ray.origin_bits"},
              "clamp(log2(2 e), 0, p), e the largest component of o - o* in ulps of the largest of o*",
              origin_lost_bits, {.needs = needs_true_ray, .domain = MetricDomain::every}),
    table_row({"direction_error", "radian", "ray.direction"},
              "angle between the direction that the form is given and the ideal one", direction_error,
              {.needs = needs_true_ray, .ramp = Ramp::magnitude, .high = 0x1p+1, .domain = MetricDomain::every}),
    table_row({"direction_lost_bits", "bits", "ray.direction_bits"},
              "clamp(log2(2 e), 0, p), e the largest component of d/|d| - d*/|d*| in ulps of the largest of d*/|d*|",
              direction_lost_bits, {.needs = needs_true_ray, .domain = MetricDomain::every}),
    table_row({"pixel_error", "pixels", "ray.pixel"},
              "for a camera whose rays each format makes: distance between the middle of the pixel and the point where "
              "the direction meets the picture; infinite where the direction points away from the picture",
              pixel_error,
              {.needs = needs_true_ray,
               .ramp = Ramp::magnitude,
               .low = 0x1p-10,
               .high = 0x1p+6,
               .domain = MetricDomain::every})};

}  // namespace

std::span<const Metric> metrics_of_rays() { return rows_of_rays; }

}  // namespace lostbits::measure::metric
