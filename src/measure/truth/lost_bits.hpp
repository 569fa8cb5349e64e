// Size of an error, in ulps of the truth and in bits.
#pragma once

#include <algorithm>
#include <cmath>

#include "measure/bits/log2.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::truth {

/// True if t is x rounded to the format, or may be, because x is not known closely enough to tell. If t is infinite, x
/// overflows by rounding alone.
inline bool may_round_to(const CertifiedNumber& x, double t, const FloatFormat& format) {
    const Neighbours ends = round_ends(x, format);
    return ends.lower == t || ends.upper == t;
}

/// (t − t*)/ulp(t*) in the format. An infinite answer has an infinite error, unless t* itself rounds to infinity: then
/// the error is 0.
inline double ulp_error(double t, const CertifiedNumber& true_t, const FloatFormat& format) {
    if (std::isinf(t)) return may_round_to(true_t, t, format) ? 0 : t;
    return scaled_difference(as_certified(t), true_t, ulp_exponent(format, true_t.floor_log2()));
}

/// Lost bits of an error in ulps: clamp(log2(2|ulps|), 0, p). Half an ulp loses none, 2^k ulps lose k + 1.
inline double lost_bits(double ulps, int precision) {
    const double magnitude = std::fabs(ulps);
    if (!(magnitude > 0.5)) return 0;
    if (std::isinf(magnitude)) return precision;
    return std::min(bits::log2_of(magnitude) + 1, static_cast<double>(precision));
}

/// log2 of the unit of a `reach` (reach.hpp). The unit is the power of two of t*, so that a reach does not leave the
/// range of double only because t* does. If t* is 0, the unit is 1.
inline std::int64_t exponent_of_unit(const CertifiedNumber& true_t) { return true_t.is_zero() ? 0 : true_t.exponent; }

/// Bits that a `reach` can cost: the lost bits of the envelope max(½, reach/ulp(t*)) ulp.
inline double inherent_bits(double reach, const CertifiedNumber& true_t, const FloatFormat& format) {
    const auto ulp = ulp_exponent(format, true_t.floor_log2());
    return lost_bits(std::ldexp(reach, static_cast<int>(exponent_of_unit(true_t) - ulp)), format.precision);
}

/// Lost bits beyond `inherent_bits`. If `inherent_bits` is p (t* = 0, or t* is smaller than its reach), a loss of all
/// bits is still compared with `reach`: log2(|t − t*| / reach), from 0 to p.
inline double excess_bits(double t, const CertifiedNumber& true_t, const FloatFormat& format, double reach) {
    const int precision = format.precision;
    const double inherent = inherent_bits(reach, true_t, format);
    if (inherent < precision) return std::max(0.0, lost_bits(ulp_error(t, true_t, format), precision) - inherent);
    if (std::isinf(t)) return may_round_to(true_t, t, format) ? 0 : precision;
    if (std::isinf(reach)) return 0;
    const int scale = std::ilogb(reach);
    const double difference = scaled_difference(as_certified(t), true_t, exponent_of_unit(true_t) + scale);
    const double ratio = std::fabs(difference) / std::ldexp(reach, -scale);
    if (!(ratio > 1)) return 0;
    return std::isinf(ratio) ? precision : std::min(bits::log2_of(ratio), static_cast<double>(precision));
}

}  // namespace lostbits::measure::truth
