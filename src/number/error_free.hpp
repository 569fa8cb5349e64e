// Error-free operations: the residual (the rounding error) of a sum, product, quotient or root of doubles is a double
// again.
#pragma once

#include <cmath>

namespace lostbits {

/// hi + lo, exactly, where hi is the double nearest to the sum.
struct DoubleDouble {
    double hi, lo;
};

/// The range in which the residuals below are exact. It applies to products, to divisors, dividends and quotients, and
/// to radicands.
///
/// A residual ρ is a multiple of a unit, which is a product of two last places: ulp(a)·ulp(b) for ab − p, ulp(q)·ulp(b)
/// for a − qb, and ulp(s)² for a − s². It has at most 53 bits above that unit (Boldo and Daumas, "Representable
/// correcting terms for possibly underflowing floating point operations", 2003). So ρ is a double if the unit is at
/// least 2^-1074. Every double, subnormal or not, has ulp(x) ≥ 2^-53 |x|, so the unit is at least 2^-106 times the
/// magnitude of ab, qb or s², that is 2^-106 · 2^-900 · (1 − 2^-52) > 2^-1007.
///
/// A residual is divided once more, ρ/b or ρ/2s, for the next digits of a quotient or root. The result keeps its 53
/// bits: where ρ ≠ 0, |ρ/b| ≥ ulp(q)·ulp(b)/|b| ≥ 2^-106 |q| > 2^-1007 is a normal number. This is why the lower limit
/// is 2^-900: down to 2^-960 the residuals themselves are still exact, but their quotients could be subnormal. The
/// upper limit is 2^1000, so that every sum and product of these operations is far from overflow.
inline constexpr double error_free_low = 0x1p-900, error_free_high = 0x1p+1000;

template <class... X>
bool residuals_are_exact(X... x) {
    return ((std::fabs(x) >= error_free_low && std::fabs(x) <= error_free_high) && ...);
}

/// a + b, exactly (2Sum of Knuth). There is no lower limit, because the residual of a sum is always a double,
/// subnormals included. No operation overflows if |a| and |b| are at most 2^1000, or if the sum is.
inline DoubleDouble two_sum(double a, double b) {
    const double s = a + b;
    const double bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

/// a + b, exactly, where |a| ≥ |b| or a = 0 (Fast2Sum of Dekker).
inline DoubleDouble quick_two_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}

/// ab, exactly, if `residuals_are_exact` for the product.
inline DoubleDouble two_product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
}

/// a − qb, where q is the double nearest to a/b.
inline double quotient_residual(double a, double b, double q) { return std::fma(-q, b, a); }

/// a − s², where s is the double nearest to √a.
inline double root_residual(double a, double s) { return std::fma(-s, s, a); }

}  // namespace lostbits
