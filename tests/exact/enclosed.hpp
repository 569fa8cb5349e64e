// Number type of the quick check: two doubles and a bound on their error.
#pragma once

#include <cmath>

namespace lostbits::exact {

/// True if a sign was requested that a bound leaves open: the result is then unknown.
inline constinit thread_local bool in_doubt = false;
/// True if the points that count have no first point: for a ray along a surface from the open end of its range.
inline constinit thread_local bool has_no_first = false;

/// |x − (high + low)| ≤ off, |low| ≤ u|high|, u = 2^-53. Where a number overflows `off` is infinite or NaN, and no sign
/// is told. Each bound is multiplied by a little more than 1 for its own few roundings; where it is subnormal its sums
/// are exact, and no product of it rounds below it.
struct Enclosed {
    double high = 0, low = 0, off = 0;

    Enclosed() = default;
    explicit Enclosed(double x) : high(x) {}
    Enclosed(double x, double y, double bound) : high(x), low(y), off(bound) {}

    /// a + b, for any two, as s + e without an error: Knuth.
    static Enclosed sum(double a, double b, double off) {
        const double s = a + b, c = s - a;
        return {s, (a - (s - c)) + (b - c), off};
    }
    friend Enclosed operator-(const Enclosed& a) { return {-a.high, -a.low, a.off}; }
    /// The errors of the words are u|v| + u|w|.
    friend Enclosed operator+(const Enclosed& a, const Enclosed& b) {
        const Enclosed s = sum(a.high, b.high, 0);
        const double v = a.low + b.low, w = s.low + v;
        return sum(s.high, w, (a.off + b.off + 0x1p-53 * (std::fabs(v) + std::fabs(w))) * (1 + 0x1p-50));
    }
    friend Enclosed operator-(const Enclosed& a, const Enclosed& b) { return a + -b; }
    /// p + q is the product of the high words but for 2^-1075. Of what else there is, x, y, x + y and their sum with q
    /// are off by u(1 + 1 + 2 + 3)u|p|, and the product of the low words is u²|p|: 2^-103|p|, and four times 2^-1075.
    friend Enclosed operator*(const Enclosed& a, const Enclosed& b) {
        const double p = a.high * b.high, q = std::fma(a.high, b.high, -p);
        const double w = q + (a.high * b.low + a.low * b.high);
        const double of_words = 0x1p-102 * std::fabs(p) + 0x1p-1000;
        return sum(p, w,
                   (std::fabs(a.high) * b.off + std::fabs(b.high) * a.off + a.off * b.off + of_words) * (1 + 0x1p-48));
    }
    /// The largest that |x| may be.
    [[nodiscard]] double most() const { return (std::fabs(high) + std::fabs(low) + off) * (1 + 0x1p-50); }
    /// The least that |x| may be, or less than 0.
    [[nodiscard]] double least() const { return std::fabs(high) * (1 - 0x1p-50) - off * (1 + 0x1p-50); }
    /// The error of q is |a − q b|/|b|, and if that underflows at most the added term.
    friend Enclosed operator/(const Enclosed& a, const Enclosed& b) {
        const double first = a.high / b.high;
        const Enclosed rest = a - Enclosed(first) * b;
        Enclosed q = sum(first, rest.high / b.high, 0);
        const double b_least = b.least();
        q.off = b_least > 0 ? (a - q * b).most() / b_least * (1 + 0x1p-50) + 0x1p-1000 : INFINITY;
        return q;
    }
    /// The error of q is |a − q²|/(√a + q).
    friend Enclosed root(const Enclosed& a) {
        const double first = std::sqrt(a.high);
        const Enclosed rest = a - Enclosed(first) * Enclosed(first);
        Enclosed q = sum(first, rest.high / (2 * first), 0);
        const double q_least = q.least();
        q.off = q_least > 0 ? (a - q * q).most() / q_least * (1 + 0x1p-50) + 0x1p-1000 : INFINITY;
        return q;
    }
    friend int sign(const Enclosed& a) {
        if (a.least() > 0) return a.high > 0 ? 1 : -1;
        if (!(a.high == 0 && a.low == 0 && a.off == 0)) in_doubt = true;
        return 0;
    }
};

}  // namespace lostbits::exact
