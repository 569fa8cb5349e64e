#include "measure/metric/errors_of_rays.hpp"

#include <cmath>

#include "measure/truth/lost_bits.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

bool is_finite(const Vec<double>& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool vanishes(const Vec<double>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

Real largest(const Vec<Real>& v) { return max(max(Real(abs(v.x)), Real(abs(v.y))), Real(abs(v.z))); }

/// In ulps of the largest component of the true vector.
double bits_off(const Vec<Real>& given, const Vec<Real>& truth, const FloatFormat& format) {
    const Real size = largest(truth);
    long floor_log2 = format.emin;
    if (size != 0) {
        int exponent = 0;
        frexp(size, &exponent);
        floor_log2 = exponent - 1;
    }
    const Real ulps = ldexp(largest(given - truth), -static_cast<int>(ulp_exponent(format, floor_log2)));
    return truth::lost_bits(ulps.convert_to<double>(), format.precision);
}

Vec<Real> unit(const Vec<Real>& v) { return (1 / length(v)) * v; }

bool has_direction(const Sample& s) { return is_finite(s.ray->direction) && !vanishes(s.ray->direction); }

}  // namespace

double origin_error(const Sample& s) {
    if (!s.true_ray) return missing;
    if (!is_finite(s.ray->origin)) return HUGE_VAL;
    return length(lift_vec<Real>(s.ray->origin) - s.true_ray->origin).convert_to<double>();
}

double origin_lost_bits(const Sample& s) {
    if (!s.true_ray) return missing;
    if (!is_finite(s.ray->origin)) return s.format->shape.precision;
    return bits_off(lift_vec<Real>(s.ray->origin), s.true_ray->origin, s.format->shape);
}

/// By the sine and the cosine, which are good near 0 and near a right angle.
double direction_error(const Sample& s) {
    if (!s.true_ray) return missing;
    if (!has_direction(s)) return HUGE_VAL;
    const Vec<Real> d = lift_vec<Real>(s.ray->direction), &truth = s.true_ray->direction;
    return atan2(length(cross(d, truth)), dot(d, truth)).convert_to<double>();
}

double direction_lost_bits(const Sample& s) {
    if (!s.true_ray) return missing;
    if (!has_direction(s)) return s.format->shape.precision;
    return bits_off(unit(lift_vec<Real>(s.ray->direction)), unit(s.true_ray->direction), s.format->shape);
}

double pixel_error(const Sample& s) {
    if (!s.true_ray || !s.frame) return missing;
    if (!has_direction(s)) return HUGE_VAL;
    const Vec<Real> d = lift_vec<Real>(s.ray->direction), &truth = s.true_ray->direction, &ahead = s.frame->forward;
    const Real depth = dot(d, ahead);
    if (depth <= 0) return HUGE_VAL;
    const Real off = length((1 / depth) * d - (1 / dot(truth, ahead)) * truth);
    return Real(off / s.frame->pitch).convert_to<double>();
}

}  // namespace lostbits::measure::metric
