#include "measure/metric/errors_of_t.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "measure/bits/log2.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

/// (x − y) in ulps of the format at t*.
double in_ulps(const Sample& s, const truth::Certified& x, const truth::Certified& y) {
    return truth::scaled_difference(x, y, ulp_exponent(s.format->shape, s.truth->floor_log2()));
}

}  // namespace

double ulp_error(const Sample& s) { return truth::ulp_error(s.t, *s.truth, s.format->shape); }
double lost(const Sample& s) { return truth::lost_bits(ulp_error(s), s.format->shape.precision); }
double correct(const Sample& s) { return s.format->shape.precision - lost(s); }

/// Of binary64 the numbers of either sign fill 63 bits: the steps between them are a number without a sign.
double herbie(const Sample& s) {
    const auto place = [&s](double x) { return truth::ordinal(x, s.format->shape); };
    const auto [low, high] = std::minmax({place(s.t), place(s.truth_rounded)});
    return bits::log2_of(1 + static_cast<double>(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low)));
}

double absolute(const Sample& s) {
    if (std::isinf(s.t)) return HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::exactly(s.t), *s.truth, 0));
}

double relative(const Sample& s) {
    if (std::isinf(s.t)) return HUGE_VAL;
    if (s.truth->is_zero()) return s.t == 0 ? 0.0 : HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::exactly(s.t), *s.truth, s.truth->exponent) /
                     (s.truth->hi + s.truth->lo));
}

double distance_error(const Sample& s) {
    const Vec<double>& d = s.ray->direction;  // of a form that asks for length one, to the format's rounding
    return absolute(s) * std::hypot(d.x, d.y, d.z);
}

double input_error(const Sample& s) { return s.own ? in_ulps(s, *s.own, *s.truth) : missing; }
double model_error(const Sample& s) { return s.own && s.self ? in_ulps(s, *s.self, *s.own) : missing; }
double rounding_error(const Sample& s) {
    if (!s.self) return missing;
    if (std::isinf(s.t)) return truth::may_round_to(*s.self, s.t, s.format->shape) ? 0 : s.t;
    return in_ulps(s, truth::exactly(s.t), *s.self);
}

}  // namespace lostbits::measure::metric
