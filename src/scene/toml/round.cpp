#include "scene/toml/round.hpp"

#include <cmath>
#include <limits>

#include <mpfr.h>

namespace lostbits::scene::toml {

double round_to_format(const Real& x, const FloatFormat& format) {
    Real scaled = x;
    mpfr_ptr raw = scaled.backend().data();
    if (mpfr_regular_p(raw) == 0) return mpfr_get_d(raw, MPFR_RNDN);

    // In units of F's last place at x, the result is an integer of at most p bits (or 2^p), which Real holds exactly.
    const bool is_negative = mpfr_signbit(raw) != 0;
    const long last_place = ulp_exponent(format, static_cast<long>(mpfr_get_exp(raw)) - 1);
    mpfr_div_2si(raw, raw, last_place, MPFR_RNDN);
    mpfr_roundeven(raw, raw);
    if (mpfr_zero_p(raw) != 0) return is_negative ? -0.0 : 0.0;
    mpfr_mul_2si(raw, raw, last_place, MPFR_RNDN);
    if (mpfr_get_exp(raw) - 1 > format.emax) return (is_negative ? -1 : 1) * std::numeric_limits<double>::infinity();
    return mpfr_get_d(raw, MPFR_RNDN);
}

double round_to_12_bits(double x) {
    if (x == 0) return 0;
    const int shift = 11 - std::ilogb(x);
    return std::ldexp(std::nearbyint(std::ldexp(x, shift)), -shift);
}

}  // namespace lostbits::scene::toml
