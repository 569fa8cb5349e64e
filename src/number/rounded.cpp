#include "number/rounded.hpp"

#include <algorithm>
#include <limits>

#include <mpfr.h>

#include "number/error.hpp"
#include "number/error_free.hpp"

namespace lostbits {

constinit thread_local const FloatFormat* CurrentFormat::current_ = nullptr;
constinit thread_local CurrentFormat::Engine CurrentFormat::engine_ = CurrentFormat::Engine::rounding;

void CurrentFormat::fail_without_format() {
    throw Error(ExitStatus::internal,
                "a number of a format chosen at run time was used where no format is set: wrap the code in "
                "CurrentFormat::Scope, or call it through with_number");
}

namespace rounding {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

int sign_of(double x) { return (x > 0) - (x < 0); }

/// 2^e for −1022 ≤ e ≤ 1023. std::ldexp, which takes any e, took a third of the time of a narrow format.
double power_of_two(int e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52); }

/// integer · 2^e for 0 ≤ integer ≤ 2^53, −1074 ≤ e ≤ 1023, if a double holds it; infinity if it is too large.
double scaled(std::uint64_t integer, int e) {
    const auto x = static_cast<double>(integer);
    return e >= -1022 ? x * power_of_two(e) : x * power_of_two(e + 128) * power_of_two(-128);
}

/// An MPFR number of 64 bits. Operations truncate to it and then set the last bit if the result is inexact ("round to
/// odd"). Rounding that number to any format of at most 62 bits is then correct (Boldo and Melquiond, 2008).
class RoundToOdd {
public:
    RoundToOdd() { mpfr_init2(x_, 64); }
    ~RoundToOdd() { mpfr_clear(x_); }
    RoundToOdd(const RoundToOdd&) = delete;
    RoundToOdd& operator=(const RoundToOdd&) = delete;
    mpfr_ptr get() { return x_; }

    double to_format(int inexact, const FloatFormat& format) {
        if (!mpfr_regular_p(x_)) return mpfr_get_d(x_, MPFR_RNDN);
        if (inexact != 0) {
            // The result is truncated to 64 bits. Its last bit is clear if it fits in 63 bits.
            if (mpfr_min_prec(x_) < 64) {
                if (mpfr_sgn(x_) > 0) mpfr_nextabove(x_);
                else mpfr_nextbelow(x_);
            }
        }
        const long q = ulp_exponent(format, static_cast<long>(mpfr_get_exp(x_)) - 1);
        mpfr_div_2si(x_, x_, q, MPFR_RNDN);
        const bool is_negative = mpfr_signbit(x_) != 0;
        mpfr_roundeven(x_, x_);
        mpfr_mul_2si(x_, x_, q, MPFR_RNDN);
        if (mpfr_zero_p(x_)) return is_negative ? -0.0 : 0.0;
        if (mpfr_get_exp(x_) - 1 > format.emax) return is_negative ? -infinity : infinity;
        return mpfr_get_d(x_, MPFR_RNDN);
    }

private:
    mpfr_t x_;
};

/// A double as an exact MPFR operand.
class ExactOperand {
public:
    explicit ExactOperand(double x) {
        mpfr_init2(x_, 53);
        mpfr_set_d(x_, x, MPFR_RNDN);
    }
    ~ExactOperand() { mpfr_clear(x_); }
    ExactOperand(const ExactOperand&) = delete;
    ExactOperand& operator=(const ExactOperand&) = delete;
    operator mpfr_srcptr() const { return x_; }

private:
    mpfr_t x_;
};

}  // namespace

double to_format(double r, int residual, const FloatFormat& format) {
    if (r == 0 || !std::isfinite(r)) return r;
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(r);
    const int biased_exponent = static_cast<int>(bits >> 52 & 0x7ff);
    std::uint64_t significand = bits & ((std::uint64_t{1} << 52) - 1);
    if (biased_exponent != 0) significand |= std::uint64_t{1} << 52;
    const int last_exponent = std::max(biased_exponent, 1) - 1075;  // r = ± significand · 2^last_exponent

    const int exponent = last_exponent + 63 - std::countl_zero(significand);
    const int dropped_count = static_cast<int>(ulp_exponent(format, exponent)) - last_exponent;
    double magnitude = std::fabs(r);
    if (dropped_count > 0) {
        if (dropped_count > 54) return std::copysign(0.0, r);  // below a quarter of the smallest subnormal

        const std::uint64_t half = std::uint64_t{1} << (dropped_count - 1);
        const std::uint64_t dropped_bits = significand & (half * 2 - 1);
        std::uint64_t rounded_significand = significand >> dropped_count;

        // Rounds to nearest, ties to even; the tail decides what only looks like a tie.
        const int tail_sign = r > 0 ? residual : -residual;  // sign of the tail; positive away from zero
        if (dropped_bits > half ||
            (dropped_bits == half && (tail_sign > 0 || (tail_sign == 0 && (rounded_significand & 1)))))
            ++rounded_significand;
        magnitude = scaled(rounded_significand, last_exponent + dropped_count);
    }

    if (magnitude >= power_of_two(format.emax) * 2) magnitude = infinity;
    return std::copysign(magnitude, r);
}

double add(double a, double b, const FloatFormat& format) {
    const auto [s, error] = two_sum(a, b);
    if (!std::isfinite(s)) return s;
    if (std::fabs(s) > error_free_high) return add_reference(a, b, format);
    return to_format(s, sign_of(error), format);
}

double mul(double a, double b, const FloatFormat& format) {
    const auto [p, error] = two_product(a, b);
    if (!residuals_are_exact(p)) return mul_reference(a, b, format);
    return to_format(p, sign_of(error), format);
}

double div(double a, double b, const FloatFormat& format) {
    const double q = a / b;
    if (!residuals_are_exact(a, b, q)) return div_reference(a, b, format);
    return to_format(q, sign_of(quotient_residual(a, b, q)) * sign_of(b), format);
}

double sqrt(double a, const FloatFormat& format) {
    const double s = std::sqrt(a);
    if (!residuals_are_exact(a)) return sqrt_reference(a, format);
    return to_format(s, sign_of(root_residual(a, s)), format);
}

double fma(double a, double b, double c, const FloatFormat& format) {
    const double p = a * b;
    if (2 * format.precision > 53 || !residuals_are_exact(p)) return fma_reference(a, b, c, format);
    return add(p, c, format);  // a·b has at most 2p ≤ 53 bits, so p is exact
}

double next_up(double a, const FloatFormat& format) {
    if (std::isnan(a) || a == infinity) return a;
    const double smallest = std::ldexp(1.0, format.emin - format.precision + 1);
    if (a == 0) return smallest;
    if (a == -infinity) return -std::ldexp(2 - std::ldexp(1.0, 1 - format.precision), format.emax);
    const double magnitude = std::fabs(a);
    const int exponent = std::ilogb(magnitude);
    double step = std::ldexp(1.0, static_cast<int>(ulp_exponent(format, exponent)));
    // Below a power of two the neighbours lie twice as close, except at the edge of the subnormals.
    if (a < 0 && exponent > format.emin && magnitude == std::ldexp(1.0, exponent)) step /= 2;
    // copysign returns −0 above the largest negative number (IEEE 754 nextUp), as nextafter does.
    return std::copysign(to_format(a + step, 0, format), a);
}

double add_reference(double a, double b, const FloatFormat& format) {
    if (a == 0 && b == 0) return a + b;
    RoundToOdd r;
    const int inexact = mpfr_add(r.get(), ExactOperand(a), ExactOperand(b), MPFR_RNDZ);
    if (mpfr_zero_p(r.get())) return a + b;
    return r.to_format(inexact, format);
}

double mul_reference(double a, double b, const FloatFormat& format) {
    RoundToOdd r;
    const int inexact = mpfr_mul(r.get(), ExactOperand(a), ExactOperand(b), MPFR_RNDZ);
    return r.to_format(inexact, format);
}

double div_reference(double a, double b, const FloatFormat& format) {
    RoundToOdd r;
    const int inexact = mpfr_div(r.get(), ExactOperand(a), ExactOperand(b), MPFR_RNDZ);
    return r.to_format(inexact, format);
}

double sqrt_reference(double a, const FloatFormat& format) {
    RoundToOdd r;
    const int inexact = mpfr_sqrt(r.get(), ExactOperand(a), MPFR_RNDZ);
    return r.to_format(inexact, format);
}

double fma_reference(double a, double b, double c, const FloatFormat& format) {
    if (a * b == 0 && c == 0 && (a == 0 || b == 0)) return a * b + c;
    RoundToOdd r;
    const int inexact = mpfr_fma(r.get(), ExactOperand(a), ExactOperand(b), ExactOperand(c), MPFR_RNDZ);
    if (mpfr_zero_p(r.get())) return std::fma(a, b, c);
    return r.to_format(inexact, format);
}

}  // namespace rounding
}  // namespace lostbits
