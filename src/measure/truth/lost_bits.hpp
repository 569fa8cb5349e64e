// How large an error is, in ulps of the truth and in bits.
#pragma once

#include <algorithm>
#include <cmath>

#include "measure/bits/log2.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::truth {

/// Whether t is x rounded to the format, or may be where x is known too loosely to tell. Of an infinite t this is an
/// overflow as rounding alone makes it.
inline bool may_round_to(const Certified& x, double t, const FloatFormat& format) {
    const Neighbours ends = round_ends(x, format);
    return ends.lower == t || ends.upper == t;
}

/// (t − t*)/ulp(t*) in that format. An infinite answer is infinitely far off, but where t* itself rounds to it: that
/// one has no error.
inline double ulp_error(double t, const Certified& truth, const FloatFormat& format) {
    if (std::isinf(t)) return may_round_to(truth, t, format) ? 0 : t;
    return scaled_difference(exactly(t), truth, ulp_exponent(format, truth.floor_log2()));
}

/// Lost bits of an error of that many ulps: clamp(log2(2|ulps|), 0, p). Half an ulp loses none, 2^k ulps lose k + 1.
inline double lost_bits(double ulps, int precision) {
    const double size = std::fabs(ulps);
    if (!(size > 0.5)) return 0;
    if (std::isinf(size)) return precision;
    return std::min(bits::log2_of(size) + 1, static_cast<double>(precision));
}

}  // namespace lostbits::measure::truth
