// Running: what is certainly true, at 53 bits and at the price of two double operations for one. It answers most
// questions of signs; where it cannot, `Ball` does.
#pragma once

#include <cmath>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Encloses every real x with |x − value| ≤ error·(1 + 2^-40): a running error analysis (Wilkinson, "Error analysis
/// revisited", 1986). An error that is not finite, or not a number, encloses everything ("don't know").
///
/// Each operation adds u|value| for its own rounding, u = 2^-53, and 2^-1000 for what may underflow in it or in the
/// error itself (the largest such loss is 2^-1074). The error is computed with at most six roundings an operation, each
/// at most u of it, and every result inherits those of its operands: what formulas of less than 1000 dependent
/// operations lose, 1000 · 6 u < 2^-40, comparisons give back. An operation that overflows or divides by what may be
/// zero has an infinite error, and so has all that is computed with it.
class Running {
public:
    Running() = default;
    explicit Running(int x) : value_(x) {}
    explicit Running(double x) : value_(x), error_(std::isfinite(x) ? 0 : HUGE_VAL) {}

    static Running unknown() { return {0, HUGE_VAL}; }

    [[nodiscard]] double value() const { return value_; }
    [[nodiscard]] double error() const { return error_ * slack; }
    [[nodiscard]] bool is_bounded() const { return error_ < HUGE_VAL; }

    friend Running operator+(const Running& a, const Running& b) {
        return rounded(a.value_ + b.value_, a.error_ + b.error_);
    }
    friend Running operator-(const Running& a) { return {-a.value_, a.error_}; }
    friend Running operator-(const Running& a, const Running& b) { return a + (-b); }
    friend Running operator*(const Running& a, const Running& b) {
        return rounded(a.value_ * b.value_,
                       std::fabs(a.value_) * b.error_ + std::fabs(b.value_) * a.error_ + a.error_ * b.error_);
    }
    /// |x/y − a/b| ≤ (error(a) + |a/b| error(b))/(|b| − error(b)).
    friend Running operator/(const Running& a, const Running& b) {
        const double least = std::fabs(b.value_) * (1 - 0x1p-50) - b.error();
        if (!(least > tiny)) return unknown();
        const double q = a.value_ / b.value_;
        return rounded(q, (a.error_ + (std::fabs(q) * (1 + 0x1p-50) + tiny) * b.error_) / least);
    }
    Running& operator+=(const Running& b) { return *this = *this + b; }
    Running& operator-=(const Running& b) { return *this = *this - b; }
    Running& operator*=(const Running& b) { return *this = *this * b; }

    /// |√x − √a| = |x − a|/(√x + √a) ≤ error(a)/√a, where no x is negative.
    friend Running sqrt(const Running& a) {
        if (!(a.value_ * (1 - 0x1p-50) > a.error())) return a.value_ == 0 && a.error_ == 0 ? a : unknown();
        const double root = std::sqrt(a.value_);
        return rounded(root, a.error_ / (root * (1 - 0x1p-50)));
    }
    friend Running fma(const Running& a, const Running& b, const Running& c) { return a * b + c; }
    friend Running abs(const Running& a) { return {std::fabs(a.value_), a.error_}; }
    friend Running copysign(const Running& a, const Running& b) {
        const Tri negative = b < Running(0);
        if (negative.is_unknown() || b.value_ == 0) return unknown();
        return negative.is_yes() ? -abs(a) : abs(a);
    }

    friend Tri operator<(const Running& a, const Running& b) {
        const Running d = b - a;
        return d.value_ > d.error() ? Tri::yes : d.value_ < -d.error() ? Tri::no : same(a, b, Tri::no);
    }
    friend Tri operator<=(const Running& a, const Running& b) {
        const Running d = b - a;
        return d.value_ > d.error() ? Tri::yes : d.value_ < -d.error() ? Tri::no : same(a, b, Tri::yes);
    }
    friend Tri operator>(const Running& a, const Running& b) { return b < a; }
    friend Tri operator>=(const Running& a, const Running& b) { return b <= a; }
    friend Running select(Tri mask, const Running& a, const Running& b) {
        if (!mask.is_unknown()) return mask.is_yes() ? a : b;
        return {a.value_, std::fabs(b.value_ - a.value_) * (1 + 0x1p-50) + a.error_ + b.error_ + tiny};
    }

private:
    static constexpr double u = 0x1p-53, tiny = 0x1p-1000, slack = 1 + 0x1p-40;

    Running(double value, double error) : value_(value), error_(error) {}
    static Running rounded(double value, double error) { return {value, error + (u * std::fabs(value) + tiny)}; }
    /// Of two exact numbers that are the same.
    static Tri same(const Running& a, const Running& b, Tri then) {
        return a.value_ == b.value_ && a.error_ == 0 && b.error_ == 0 ? then : Tri(Tri::unknown);
    }

    double value_ = 0, error_ = 0;
};

template <>
inline constexpr bool stands_for_exact<Running> = true;

static_assert(Number<Running>);

}  // namespace lostbits
