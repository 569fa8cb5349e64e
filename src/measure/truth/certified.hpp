// A real number known to within a bound: the result of an enclosure.
#pragma once

#include <cstdint>
#include <optional>

#include "number/ball.hpp"
#include "number/format.hpp"
#include "number/interval.hpp"

namespace lostbits::measure::truth {

/// x = (hi + lo)·2^exponent with 1 ≤ |hi| < 2 (or x = 0 exactly), |x − (hi + lo)·2^exponent| ≤ bound·2^exponent.
/// The exponent is apart so that numbers beyond the range of double are values like any other.
struct Certified {
    double hi = 0;
    double lo = 0;
    double bound = 0;
    std::int64_t exponent = 0;

    [[nodiscard]] bool is_zero() const { return hi == 0; }
    /// ⌊log2|x|⌋ of the midpoint; very negative for zero.
    [[nodiscard]] long floor_log2() const;
};

/// The relative bound that every certified value meets: 2^-72, which is 2^-19 of a double's last place.
inline constexpr double certified_tightness = 0x1p-72;

/// The midpoint and bound of an enclosure, or nothing where it is not tight enough (or unbounded).
std::optional<Certified> certify(const Ball& x, double tightness = certified_tightness);
std::optional<Certified> certify(const Interval& x, double tightness = certified_tightness);

/// hi + lo ± bound, |lo| ≤ ulp(hi)/2, of any size; hi = 0 stands for zero exactly.
Certified certified(double hi, double lo, double bound);

/// (x − y)/2^e for the midpoints of both, as a double, to a relative error of 2^-50; infinite where it exceeds double's
/// range. x and y may be any numbers, equal exponents not required.
double scaled_difference(const Certified& x, const Certified& y, std::int64_t e);

/// A finite double as a certified value with bound zero.
Certified exactly(double x);

/// Enclosure of both: the nearest of two intersections where they cannot be told apart.
Certified nearer(const Certified& x, const Certified& y);
/// −1, 0 (cannot be decided), or +1.
int compare(const Certified& x, const Certified& y);

/// Both ends of x, each rounded to nearest even in a format: one number, or two neighbours where the bound straddles
/// the boundary between them.
struct Neighbours {
    double lower, upper;
};
Neighbours round_ends(const Certified& x, const FloatFormat& format);
/// x rounded to nearest even in a format, or nothing where the bound straddles a rounding boundary.
std::optional<double> round_certified(const Certified& x, const FloatFormat& format);

/// |x|/2^emin-scaled position in the format's ordering: 0 for zero, +1 per representable number, negative below zero.
/// Infinity follows the largest finite number. x must be a number of the format.
std::int64_t ordinal(double x, const FloatFormat& format);
/// Finite number of that ordinal.
double number_at(std::int64_t ordinal, const FloatFormat& format);

}  // namespace lostbits::measure::truth
