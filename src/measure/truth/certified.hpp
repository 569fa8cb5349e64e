// A real number known to within a bound: the result of an enclosure.
#pragma once

#include <cstdint>
#include <optional>

#include "number/ball.hpp"
#include "number/format.hpp"
#include "number/interval.hpp"

namespace lostbits::measure::truth {

/// x = (hi + lo)·2^exponent with 1 ≤ |hi| < 2 (or x = 0 exactly), |x − (hi + lo)·2^exponent| ≤ bound·2^exponent. The
/// exponent is stored separately, so that numbers beyond the range of double need no special case.
struct CertifiedNumber {
    double hi = 0;
    double lo = 0;
    double bound = 0;
    std::int64_t exponent = 0;

    [[nodiscard]] bool is_zero() const { return hi == 0; }
    /// ⌊log2|x|⌋ of the midpoint; very negative for zero.
    [[nodiscard]] long floor_log2() const;
};

/// Largest relative bound of a certified value: 2^-72, which is 2^-19 of a double's last place.
inline constexpr double certified_tightness = 0x1p-72;

/// Midpoint and bound of an enclosure; empty if the enclosure is unbounded or its bound exceeds `tightness`.
std::optional<CertifiedNumber> certify(const Ball& x, double tightness = certified_tightness);
std::optional<CertifiedNumber> certify(const Interval& x, double tightness = certified_tightness);

/// The number hi + lo ± bound, |lo| ≤ ulp(hi)/2, of any size; hi = 0 means exactly zero.
CertifiedNumber make_certified(double hi, double lo, double bound);

/// (x − y)/2^e of the midpoints, as a double, to a relative error of 2^-50; infinite if it exceeds the range of double.
/// The exponents of x and y may differ.
double scaled_difference(const CertifiedNumber& x, const CertifiedNumber& y, std::int64_t e);

/// A finite double as a certified value with bound zero.
CertifiedNumber as_certified(double x);

/// Nearer of two intersections; if their order cannot be decided, an enclosure of both.
CertifiedNumber nearer(const CertifiedNumber& x, const CertifiedNumber& y);
/// Order of x and y: −1 if x < y, +1 if x > y, 0 if the bounds do not decide.
int compare(const CertifiedNumber& x, const CertifiedNumber& y);

/// Both ends of x, each rounded to nearest even in a format: one number, or two neighbours if the bound straddles the
/// boundary between them.
struct Neighbours {
    double lower, upper;
};
Neighbours round_ends(const CertifiedNumber& x, const FloatFormat& format);
/// x rounded to nearest even in a format; empty if the bound straddles a rounding boundary.
std::optional<double> round_certified(const CertifiedNumber& x, const FloatFormat& format);

/// Position of x in the order of the numbers of the format: 0 for zero, +1 for each representable number, negative
/// below zero. Infinity follows the largest finite number. x must be a number of the format.
std::int64_t ordinal(double x, const FloatFormat& format);
/// Finite number that has this ordinal.
double number_at(std::int64_t ordinal, const FloatFormat& format);

}  // namespace lostbits::measure::truth
