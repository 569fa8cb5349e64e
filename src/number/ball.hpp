// Ball: an enclosure of the exact value with about 100 bits, at the cost of a few dozen double operations. Its midpoint
// is a double-double, its radius a double. It answers most rays; `Interval` answers the rest.
#pragma once

#include "number/concept.hpp"
#include "number/error_free.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Encloses every real x with |x − (hi + lo)| ≤ radius. A radius of infinity encloses everything ("don't know").
///
/// Double-double bounds (Joldes, Muller and Popescu, "Tight and rigorous error bounds for basic building blocks of
/// double-word arithmetic", 2017; the root: Lefèvre et al., 2023), u = 2^-53: sum 3u² + 13u³, product 5u²,
/// quotient 15u² + 56u³, root 25/8 u². All are below 2^-102; `dd_error` allows four times that.
/// They hold while nothing underflows or overflows: results outside [2^-900, 2^900] become "don't know".
class Ball {
public:
    Ball() = default;
    explicit Ball(int x) : hi_(x) {}
    explicit Ball(double x) : hi_(x) {
        if (!std::isfinite(x)) *this = unknown();
    }
    /// hi + lo ± radius, with |lo| ≤ ulp(hi)/2.
    Ball(double hi, double lo, double radius) : hi_(hi), lo_(lo), radius_(radius) {}

    static Ball unknown(Undefined u = Undefined::maybe) {
        Ball b;
        b.radius_ = HUGE_VAL;
        b.undefined_ = u;
        return b;
    }

    [[nodiscard]] double hi() const { return hi_; }
    [[nodiscard]] double lo() const { return lo_; }
    [[nodiscard]] double radius() const { return radius_; }
    [[nodiscard]] Undefined undefined() const { return undefined_; }
    [[nodiscard]] bool is_bounded() const { return radius_ < HUGE_VAL && undefined_ == Undefined::never; }
    [[nodiscard]] bool is_exact() const { return radius_ == 0 && undefined_ == Undefined::never; }

    friend Ball operator+(const Ball& a, const Ball& b) {
        const double spread = a.radius_ + b.radius_;
        const DoubleDouble s = two_sum(a.hi_, b.hi_);
        // The sum of two doubles is a double-double, exactly.
        if (a.lo_ == 0 && b.lo_ == 0) return finish(s, spread, are_points(a, b), either(a, b));
        const DoubleDouble t = two_sum(a.lo_, b.lo_);
        const DoubleDouble v = quick_two_sum(s.hi, s.lo + t.hi);
        return finish(quick_two_sum(v.hi, t.lo + v.lo), spread, false, either(a, b));
    }
    friend Ball operator-(const Ball& a) {
        Ball r = a;
        r.hi_ = -a.hi_;
        r.lo_ = -a.lo_;
        return r;
    }
    friend Ball operator-(const Ball& a, const Ball& b) { return a + (-b); }
    friend Ball operator*(const Ball& a, const Ball& b) {
        if (a.is_zero() || b.is_zero()) return a.is_bounded() && b.is_bounded() ? Ball(0) : unknown();
        const DoubleDouble p = two_product(a.hi_, b.hi_);
        const double spread = std::fabs(a.hi_) * b.radius_ + std::fabs(b.hi_) * a.radius_ + a.radius_ * b.radius_;
        // A midpoint of zero inside a wide ball is a legitimate factor: only its radius counts.
        const bool of_zero = a.hi_ == 0 || b.hi_ == 0, one_word = a.lo_ == 0 && b.lo_ == 0;
        if (one_word) return in_range(p.hi) || of_zero ? finish(p, spread, are_points(a, b), either(a, b)) : unknown();
        const DoubleDouble r = quick_two_sum(p.hi, p.lo + std::fma(a.hi_, b.lo_, a.lo_ * b.hi_));
        if (!in_range(r.hi) && !of_zero) return unknown();
        return finish(r, spread, false, either(a, b));
    }
    friend Ball operator/(const Ball& a, const Ball& b) {
        const double distance_from_zero = std::fabs(b.hi_) * (1 - 0x1p-50) - b.radius_;
        if (!(distance_from_zero > 0)) return unknown();
        if (a.is_zero()) return a.is_bounded() && b.is_bounded() ? Ball(0) : unknown();
        const double qh = a.hi_ / b.hi_;
        if (!in_range(qh) || !in_range(a.hi_)) return unknown();
        // r = a − qh·b, which is small enough to be a double-double again.
        const double rh = quotient_residual(a.hi_, b.hi_, qh);
        const double ql = (rh + (a.lo_ - qh * b.lo_)) / b.hi_;
        const double spread = (a.radius_ + (std::fabs(qh) * (1 + 0x1p-50)) * b.radius_) / distance_from_zero;
        return finish(quick_two_sum(qh, ql), spread, false, either(a, b));
    }
    Ball& operator+=(const Ball& b) { return *this = *this + b; }
    Ball& operator-=(const Ball& b) { return *this = *this - b; }
    Ball& operator*=(const Ball& b) { return *this = *this * b; }

    friend Ball sqrt(const Ball& a) {
        if (a.undefined_ == Undefined::always) return a;
        if (a.is_zero()) return a.is_bounded() ? Ball(0) : unknown();
        if (a.hi_ * (1 - 0x1p-50) <= a.radius_) {
            const bool negative = a.hi_ < 0 && -a.hi_ * (1 - 0x1p-50) > a.radius_ && a.is_bounded();
            return unknown(negative ? Undefined::always : Undefined::maybe);
        }
        if (!in_range(a.hi_)) return unknown();
        const double sh = std::sqrt(a.hi_);
        const double sl = (a.lo_ + root_residual(a.hi_, sh)) / (2 * sh);
        // |√x − √a| = |x − a|/(√x + √a) ≤ radius/√a
        return finish(quick_two_sum(sh, sl), a.radius_ / (sh * (1 - 0x1p-50)), false, a.undefined_);
    }
    friend Ball fma(const Ball& a, const Ball& b, const Ball& c) { return a * b + c; }
    friend Ball abs(const Ball& a) {
        if (!a.is_bounded()) return a;
        return a.hi_ < 0 ? -a : a;  // | |x| − |m| | ≤ |x − m|
    }
    friend Ball copysign(const Ball& a, const Ball& b) {
        const Tri negative = b < Ball(0);
        // `negative` is a plain no if b is certainly NaN; the sign of a NaN may be either.
        if (negative.is_unknown() || b.is_zero() || !b.is_bounded()) return unknown();
        return negative.is_yes() ? -abs(a) : abs(a);
    }

    friend Tri operator<(const Ball& a, const Ball& b) {
        return guarded(sign(a - b, Tri::yes, Tri::no, Tri::no), either(a, b));
    }
    friend Tri operator<=(const Ball& a, const Ball& b) {
        return guarded(sign(a - b, Tri::yes, Tri::yes, Tri::no), either(a, b));
    }
    friend Tri operator>(const Ball& a, const Ball& b) { return b < a; }
    friend Tri operator>=(const Ball& a, const Ball& b) { return b <= a; }
    /// Encloses both sides if the mask is undecided: with the midpoint of a and the radius |b − a| + radius(a) +
    /// radius(b), which holds the points of either.
    friend Ball select(Tri mask, const Ball& a, const Ball& b) {
        if (!mask.is_unknown()) return mask.is_yes() ? a : b;
        const bool same = a.hi_ == b.hi_ && a.lo_ == b.lo_ && a.radius_ == b.radius_ && a.undefined_ == b.undefined_;
        if (same) return a;
        if (!a.is_bounded() || !b.is_bounded()) return unknown();
        const Ball apart = b - a;
        if (!apart.is_bounded()) return unknown();
        return Ball(a.hi_, a.lo_,
                    (std::fabs(apart.hi_) * (1 + 0x1p-50) + apart.radius_ + a.radius_ + b.radius_) * inflate);
    }

private:
    static constexpr double dd_error = 0x1p-100;
    // The radius is itself computed with rounding: at most ten operations, each off by 2^-53; and a product in it
    // may underflow, so every inexact ball carries at least `smallest_radius`.
    static constexpr double inflate = 1 + 0x1p-45;
    static constexpr double smallest_radius = 0x1p-960;

    // Below 2^1000, so that radii do not overflow either.
    static constexpr double largest = 0x1p+900;
    static bool in_range(double x) { return std::fabs(x) >= error_free_low && std::fabs(x) <= largest; }
    static bool are_points(const Ball& a, const Ball& b) { return a.radius_ == 0 && b.radius_ == 0; }
    [[nodiscard]] bool is_zero() const { return hi_ == 0 && radius_ == 0; }
    static Undefined either(const Ball& a, const Ball& b) { return spread(a.undefined_, b.undefined_); }

    static Ball finish(DoubleDouble middle, double spread, bool exact, Undefined u) {
        if (!exact) spread = (spread + std::fabs(middle.hi) * dd_error) * inflate + smallest_radius;
        if (!(std::fabs(middle.hi) <= largest) || !(spread < HUGE_VAL))
            return unknown(u == Undefined::always ? u : Undefined::maybe);
        Ball r(middle.hi, middle.lo, spread);
        r.undefined_ = u;
        return r;
    }

    static Tri sign(const Ball& d, Tri negative, Tri zero, Tri positive) {
        if (!(d.radius_ < HUGE_VAL)) return Tri::unknown;
        if (d.radius_ == 0) return d.hi_ < 0 ? negative : d.hi_ > 0 ? positive : zero;
        const double size = std::fabs(d.hi_) * (1 - 0x1p-50);
        if (size > d.radius_) return d.hi_ < 0 ? negative : positive;
        return Tri::unknown;
    }

    double hi_ = 0, lo_ = 0, radius_ = 0;
    Undefined undefined_ = Undefined::never;
};

/// Root searches in enclosures need these: a point of a ball, the ball of two points, the largest magnitude in a ball
/// as a point, and the number of bits that a ball has.
inline Ball middle(const Ball& x) { return {x.hi(), x.lo(), 0}; }
inline Ball between(const Ball& low, const Ball& high) {
    const Ball m = middle(Ball(0.5) * (low + high)), half = high - m, other = m - low;
    return {m.hi(), m.lo(), (std::fmax(half.hi(), other.hi()) + half.radius() + other.radius()) * (1 + 0x1p-45)};
}
inline Ball largest(const Ball& x) { return Ball((std::fabs(x.hi()) + x.radius()) * (1 + 0x1p-50)); }
inline int precision_of(const Ball&) { return 100; }

template <>
inline constexpr bool is_exact<Ball> = true;

static_assert(Number<Ball>);

}  // namespace lostbits
