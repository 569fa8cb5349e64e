// Error-free operations: the rounding error of a sum, product, quotient or root of doubles is a double again.
#pragma once

#include <cmath>

namespace lostbits {

/// hi + lo, exactly, where hi is the double nearest to it.
struct DoubleDouble {
    double hi, lo;
};

/// The range of results, factors, dividends and divisors, and radicands in which the residuals below are exact.
///
/// A residual ρ is a multiple of a product of two last places: ulp(a)·ulp(b) for ab − p, ulp(q)·ulp(b) for a − qb,
/// ulp(s)² for a − s²; and it has at most 53 bits above that unit (Boldo and Daumas, "Representable correcting terms
/// for possibly underflowing floating point operations", 2003). So it is a double wherever the unit is at least
/// 2^-1074. Every double, subnormal or not, has ulp(x) ≥ 2^-53 |x|, so the unit is at least 2^-106 times the size of
/// ab, qb or s², that is 2^-106 · 2^-900 · (1 − 2^-52) > 2^-1007.
///
/// A residual divided once more (ρ/b, ρ/2s: the next digits of a quotient or root) keeps its 53 bits: where ρ ≠ 0,
/// |ρ/b| ≥ ulp(q)·ulp(b)/|b| ≥ 2^-106 |q| > 2^-1007 is a normal number. Down to 2^-960, where the residuals themselves
/// are still exact, that would fail. Above, 2^1000 leaves every sum and product of these steps far from overflow.
inline constexpr double error_free_low = 0x1p-900, error_free_high = 0x1p+1000;

template <class... X>
bool residuals_are_exact(X... x) {
    return ((std::fabs(x) >= error_free_low && std::fabs(x) <= error_free_high) && ...);
}

/// a + b (Knuth). There is no lower limit: the error of a sum is a double, subnormals included. Upper limit: |a|, |b| ≤
/// 2^1000, or a sum of at most that size; then no step overflows.
inline DoubleDouble two_sum(double a, double b) {
    const double s = a + b;
    const double bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

/// a + b where |a| ≥ |b| or a = 0 (Dekker).
inline DoubleDouble quick_two_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}

/// ab.
inline DoubleDouble two_product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
}

/// a − qb, where q is the double nearest to a/b.
inline double quotient_residual(double a, double b, double q) { return std::fma(-q, b, a); }

/// a − s², where s is the double nearest to √a.
inline double root_residual(double a, double s) { return std::fma(-s, s, a); }

}  // namespace lostbits
