#include "measure/truth/certified.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "number/error_free.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::truth {
namespace {

/// 2^e, if it is a normal number.
double power_of_two(std::int64_t e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52); }

/// Same as ilogb, without the call for normal numbers.
int exponent_of(double x) {
    const auto biased = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff);
    return biased != 0 && biased != 0x7ff ? biased - 1023 : std::ilogb(x);
}

/// x·2^e. The exponent saturates, since exponents here may exceed int. A product with a power of two rounds as ldexp
/// does.
double scale(double x, std::int64_t e) {
    if (e >= -1022 && e <= 1023) return x * power_of_two(e);
    return std::ldexp(x, static_cast<int>(std::clamp<std::int64_t>(e, -5000, 5000)));
}

/// The number (hi + lo ± bound)·2^exponent in the form that `CertifiedNumber` requires.
CertifiedNumber normalise(double hi, double lo, double bound, std::int64_t exponent) {
    const DoubleDouble s = two_sum(hi, lo);
    const int e = exponent_of(s.hi);
    CertifiedNumber r{scale(s.hi, -e), scale(s.lo, -e), scale(bound, -e), exponent + e};
    // Scaling is exact unless it underflows. Underflow changes lo and bound by at most half of 2^-1074 each.
    if (scale(r.lo, e) != s.lo || scale(r.bound, e) != bound) r.bound += 0x1p-1074;
    return r;
}

}  // namespace

long CertifiedNumber::floor_log2() const {
    if (hi == 0) return std::numeric_limits<int>::min() / 2;
    // hi = ±1 with lo pointing to zero lies in the binade below.
    const bool is_in_lower_binade = std::fabs(hi) == 1 && ((hi > 0 && lo < 0) || (hi < 0 && lo > 0));
    return static_cast<long>(exponent) - (is_in_lower_binade ? 1 : 0);
}

CertifiedNumber as_certified(double x) {
    if (x == 0) return {};
    const int e = exponent_of(x);
    return {scale(x, -e), 0, 0, e};
}

CertifiedNumber make_certified(double hi, double lo, double bound) {
    return hi == 0 ? CertifiedNumber{} : normalise(hi, lo, bound, 0);
}

std::optional<CertifiedNumber> certify(const Ball& x, double tightness) {
    if (!x.is_bounded()) return std::nullopt;
    if (x.hi() == 0) return x.is_exact() ? std::optional<CertifiedNumber>(CertifiedNumber{}) : std::nullopt;
    if (x.radius() > tightness * std::fabs(x.hi())) return std::nullopt;
    return normalise(x.hi(), x.lo(), x.radius(), 0);
}

std::optional<CertifiedNumber> certify(const Interval& x, double tightness) {
    if (!x.is_bounded()) return std::nullopt;
    if (mpfr_zero_p(x.lower()) != 0 && mpfr_zero_p(x.upper()) != 0) return CertifiedNumber{};
    if (mpfr_sgn(x.lower()) * mpfr_sgn(x.upper()) <= 0) return std::nullopt;
    const mpfr_exp_t e = mpfr_get_exp(x.lower()) - 1;
    // All numbers are in units of 2^e. hi + lo is the lower end to 106 bits, and the rest of the interval goes into the
    // bound.
    mpfr_t work;
    mpfr_init2(work, std::max(mpfr_get_prec(x.lower()), mpfr_get_prec(x.upper())) + 64);
    mpfr_sub(work, x.upper(), x.lower(), MPFR_RNDU);
    mpfr_div_2si(work, work, e, MPFR_RNDU);
    const double interval_width = mpfr_get_d(work, MPFR_RNDU);
    mpfr_div_2si(work, x.lower(), e, MPFR_RNDN);
    const double hi = mpfr_get_d(work, MPFR_RNDN);
    mpfr_sub_d(work, work, hi, MPFR_RNDN);
    const double lo = mpfr_get_d(work, MPFR_RNDN);
    mpfr_sub_d(work, work, lo, MPFR_RNDN);
    mpfr_abs(work, work, MPFR_RNDU);
    const double tail = mpfr_get_d(work, MPFR_RNDU);
    mpfr_clear(work);
    const double bound = (interval_width + tail) * (1 + 0x1p-50);
    if (!(bound <= tightness)) return std::nullopt;
    return normalise(hi, lo, bound, e);
}

double scaled_difference(const CertifiedNumber& x, const CertifiedNumber& y, std::int64_t e) {
    if (y.is_zero()) return scale(x.hi + x.lo, x.exponent - e);
    if (x.is_zero()) return scale(-(y.hi + y.lo), y.exponent - e);
    const std::int64_t larger_exponent = std::max(x.exponent, y.exponent);
    const auto in_common_unit = [&](double word, std::int64_t exponent) {
        return scale(word, exponent - larger_exponent);
    };
    const DoubleDouble d = two_sum(in_common_unit(x.hi, x.exponent), -in_common_unit(y.hi, y.exponent));
    const DoubleDouble tail = two_sum(in_common_unit(x.lo, x.exponent), -in_common_unit(y.lo, y.exponent));
    // If d.hi and tail.hi cancel, d.hi is itself the result of a cancellation and d.lo = 0, so nothing is lost.
    const DoubleDouble sum = two_sum(d.hi, tail.hi);
    return scale(sum.hi + (sum.lo + d.lo + tail.lo), larger_exponent - e);
}

int compare(const CertifiedNumber& x, const CertifiedNumber& y) {
    const std::int64_t larger_exponent =
        std::max(x.is_zero() ? y.exponent : x.exponent, y.is_zero() ? x.exponent : y.exponent);
    const double d = scaled_difference(x, y, larger_exponent);
    const double margin =
        (scale(x.bound, x.exponent - larger_exponent) + scale(y.bound, y.exponent - larger_exponent)) * (1 + 0x1p-40);
    // d has a relative error of a few 2^-53, and the losses to underflow in scaling are below 2^-1000.
    if (std::fabs(d) * (1 - 0x1p-40) > margin + 0x1p-1000) return d < 0 ? -1 : 1;
    return 0;
}

CertifiedNumber nearer(const CertifiedNumber& x, const CertifiedNumber& y) {
    const int order = compare(x, y);
    if (order != 0) return order < 0 ? x : y;
    // The order is not decided. The smaller number lies within both bounds plus the distance of the midpoints, from
    // either midpoint.
    if (x.is_zero()) return x;
    CertifiedNumber enclosure = x;
    const double midpoint_distance = std::fabs(scaled_difference(x, y, x.exponent));
    enclosure.bound = (x.bound + scale(y.bound, y.exponent - x.exponent) + midpoint_distance) * (1 + 0x1p-40);
    return enclosure;
}

Neighbours round_ends(const CertifiedNumber& x, const FloatFormat& format) {
    if (x.is_zero()) return {0, 0};
    const auto round_shifted = [&](double shift) {
        // hi + lo + shift = nearest double + rest, exactly. Correct rounding needs only the sign of the rest.
        const DoubleDouble outer = two_sum(x.lo, shift);
        DoubleDouble s = two_sum(x.hi, outer.hi);
        const DoubleDouble rest = two_sum(s.lo, outer.lo);
        int residual = (rest.hi > 0) - (rest.hi < 0);
        // s.hi was rounded without outer.lo; at a tie, it may be the wrong neighbour.
        const double neighbour = std::nextafter(s.hi, rest.hi > 0 ? HUGE_VAL : -HUGE_VAL);
        if (rest.hi != 0 && neighbour - s.hi == 2 * rest.hi && rest.lo != 0 && (rest.lo > 0) == (rest.hi > 0)) {
            s.hi = neighbour;
            residual = -residual;
        }
        // Rounds in units of 2^exponent, to a format whose exponents are shifted by the same amount.
        const auto shifted_exponent = [&](std::int64_t bound) {
            return static_cast<int>(std::clamp<std::int64_t>(bound - x.exponent, -4000, 4000));
        };
        FloatFormat shifted_format{format.precision, shifted_exponent(format.emin), 1000};
        double r = rounding::to_format(s.hi, residual, shifted_format);
        if (shifted_format.emin > 60) r = 0;  // far below the smallest subnormal
        const int emax = shifted_exponent(format.emax);
        if (r != 0 && std::ilogb(r) > emax) return std::copysign(std::numeric_limits<double>::infinity(), r);
        return scale(r, x.exponent);
    };
    return {round_shifted(-x.bound), round_shifted(x.bound)};
}

std::optional<double> round_certified(const CertifiedNumber& x, const FloatFormat& format) {
    const Neighbours ends = round_ends(x, format);
    if (ends.lower == ends.upper) return ends.lower;
    return std::nullopt;
}

std::int64_t ordinal(double x, const FloatFormat& format) {
    const double magnitude = std::fabs(x);
    const std::int64_t numbers_per_binade = std::int64_t{1} << (format.precision - 1);
    std::int64_t n = 0;
    if (std::isinf(magnitude)) {
        n = numbers_per_binade * (format.emax - format.emin + 2);
    } else if (magnitude != 0) {
        const int e = std::max(std::ilogb(magnitude), format.emin);
        n = numbers_per_binade * (e - format.emin) +
            static_cast<std::int64_t>(std::ldexp(magnitude, format.precision - 1 - e));
    }
    return x < 0 ? -n : n;
}

double number_at(std::int64_t n, const FloatFormat& format) {
    const std::int64_t numbers_per_binade = std::int64_t{1} << (format.precision - 1);
    const std::int64_t magnitude = std::abs(n), e = magnitude / numbers_per_binade, m = magnitude % numbers_per_binade;
    const double y = e == 0 ? std::ldexp(static_cast<double>(m), format.emin - format.precision + 1)
                            : std::ldexp(static_cast<double>(numbers_per_binade + m),
                                         format.emin + static_cast<int>(e) - format.precision);
    return n < 0 ? -y : y;
}

}  // namespace lostbits::measure::truth
