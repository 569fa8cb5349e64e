// Ball: an enclosure of the exact value with about 100 bits, at the cost of a few dozen double operations. Its midpoint
// is a double-double, its radius a double. `Ball` decides most rays; `Interval` decides the rest.
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
        if (!std::isfinite(x)) *this = all_reals();
    }
    /// hi + lo ± radius, with |lo| ≤ ulp(hi)/2.
    Ball(double hi, double lo, double radius) : hi_(hi), lo_(lo), radius_(radius) {}

    static Ball all_reals(Undefined u = Undefined::maybe) {
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
        const double propagated_radius = a.radius_ + b.radius_;
        const DoubleDouble s = two_sum(a.hi_, b.hi_);
        // The sum of two doubles is a double-double, exactly.
        if (a.lo_ == 0 && b.lo_ == 0) return finish(s, propagated_radius, are_points(a, b), undefined_of(a, b));
        const DoubleDouble t = two_sum(a.lo_, b.lo_);
        const DoubleDouble v = quick_two_sum(s.hi, s.lo + t.hi);
        return finish(quick_two_sum(v.hi, t.lo + v.lo), propagated_radius, false, undefined_of(a, b));
    }
    friend Ball operator-(const Ball& a) {
        Ball r = a;
        r.hi_ = -a.hi_;
        r.lo_ = -a.lo_;
        return r;
    }
    friend Ball operator-(const Ball& a, const Ball& b) { return a + (-b); }
    friend Ball operator*(const Ball& a, const Ball& b) {
        if (a.is_zero() || b.is_zero()) return a.is_bounded() && b.is_bounded() ? Ball(0) : all_reals();
        const DoubleDouble p = two_product(a.hi_, b.hi_);
        const double propagated_radius =
            std::fabs(a.hi_) * b.radius_ + std::fabs(b.hi_) * a.radius_ + a.radius_ * b.radius_;
        // A midpoint of zero inside a wide ball is a legitimate factor: only its radius counts.
        const bool has_zero_midpoint = a.hi_ == 0 || b.hi_ == 0, are_doubles = a.lo_ == 0 && b.lo_ == 0;
        if (are_doubles)
            return is_in_range(p.hi) || has_zero_midpoint
                       ? finish(p, propagated_radius, are_points(a, b), undefined_of(a, b))
                       : all_reals();
        const DoubleDouble r = quick_two_sum(p.hi, p.lo + std::fma(a.hi_, b.lo_, a.lo_ * b.hi_));
        if (!is_in_range(r.hi) && !has_zero_midpoint) return all_reals();
        return finish(r, propagated_radius, false, undefined_of(a, b));
    }
    friend Ball operator/(const Ball& a, const Ball& b) {
        const double distance_from_zero = std::fabs(b.hi_) * (1 - 0x1p-50) - b.radius_;
        if (!(distance_from_zero > 0)) return all_reals();
        if (a.is_zero()) return a.is_bounded() && b.is_bounded() ? Ball(0) : all_reals();
        const double qh = a.hi_ / b.hi_;
        if (!is_in_range(qh) || !is_in_range(a.hi_)) return all_reals();
        // The remainder a − qh·b is small enough to be a double-double again.
        const double rh = quotient_residual(a.hi_, b.hi_, qh);
        const double ql = (rh + (a.lo_ - qh * b.lo_)) / b.hi_;
        const double propagated_radius = (a.radius_ + (std::fabs(qh) * (1 + 0x1p-50)) * b.radius_) / distance_from_zero;
        return finish(quick_two_sum(qh, ql), propagated_radius, false, undefined_of(a, b));
    }
    Ball& operator+=(const Ball& b) { return *this = *this + b; }
    Ball& operator-=(const Ball& b) { return *this = *this - b; }
    Ball& operator*=(const Ball& b) { return *this = *this * b; }

    friend Ball sqrt(const Ball& a) {
        if (a.undefined_ == Undefined::always) return a;
        if (a.is_zero()) return a.is_bounded() ? Ball(0) : all_reals();
        if (a.hi_ * (1 - 0x1p-50) <= a.radius_) {
            const bool is_negative = a.hi_ < 0 && -a.hi_ * (1 - 0x1p-50) > a.radius_ && a.is_bounded();
            return all_reals(is_negative ? Undefined::always : Undefined::maybe);
        }
        if (!is_in_range(a.hi_)) return all_reals();
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
        const Tri is_negative = b < Ball(0);
        // `is_negative` is a plain no if b is certainly NaN; the sign of a NaN may be either.
        if (is_negative.is_unknown() || b.is_zero() || !b.is_bounded()) return all_reals();
        return is_negative.is_yes() ? -abs(a) : abs(a);
    }

    friend Tri operator<(const Ball& a, const Ball& b) {
        return guard_undefined(decide_by_sign(a - b, Tri::yes, Tri::no, Tri::no), undefined_of(a, b));
    }
    friend Tri operator<=(const Ball& a, const Ball& b) {
        return guard_undefined(decide_by_sign(a - b, Tri::yes, Tri::yes, Tri::no), undefined_of(a, b));
    }
    friend Tri operator>(const Ball& a, const Ball& b) { return b < a; }
    friend Tri operator>=(const Ball& a, const Ball& b) { return b <= a; }
    /// Encloses both a and b if the mask is undecided: the midpoint is that of a, and the radius is |b − a| + radius(a)
    /// + radius(b).
    friend Ball select(Tri mask, const Ball& a, const Ball& b) {
        if (!mask.is_unknown()) return mask.is_yes() ? a : b;
        const bool are_equal =
            a.hi_ == b.hi_ && a.lo_ == b.lo_ && a.radius_ == b.radius_ && a.undefined_ == b.undefined_;
        if (are_equal) return a;
        if (!a.is_bounded() || !b.is_bounded()) return all_reals();
        const Ball difference = b - a;
        if (!difference.is_bounded()) return all_reals();
        return Ball(a.hi_, a.lo_,
                    (std::fabs(difference.hi_) * (1 + 0x1p-50) + difference.radius_ + a.radius_ + b.radius_) *
                        radius_inflation);
    }

private:
    static constexpr double dd_error = 0x1p-100;
    // Covers the rounding errors of the radius itself: at most ten operations with a relative error of 2^-53 each.
    // A product among them may underflow, so every inexact ball has a radius of at least `smallest_radius`.
    static constexpr double radius_inflation = 1 + 0x1p-45;
    static constexpr double smallest_radius = 0x1p-960;

    // Largest midpoint. It is below 2^1000, so that radii do not overflow either.
    static constexpr double largest_midpoint = 0x1p+900;
    static bool is_in_range(double x) { return std::fabs(x) >= error_free_low && std::fabs(x) <= largest_midpoint; }
    static bool are_points(const Ball& a, const Ball& b) { return a.radius_ == 0 && b.radius_ == 0; }
    [[nodiscard]] bool is_zero() const { return hi_ == 0 && radius_ == 0; }
    static Undefined undefined_of(const Ball& a, const Ball& b) {
        return combine_undefined(a.undefined_, b.undefined_);
    }

    static Ball finish(DoubleDouble midpoint, double radius, bool is_error_free, Undefined u) {
        if (!is_error_free) radius = (radius + std::fabs(midpoint.hi) * dd_error) * radius_inflation + smallest_radius;
        if (!(std::fabs(midpoint.hi) <= largest_midpoint) || !(radius < HUGE_VAL))
            return all_reals(u == Undefined::always ? u : Undefined::maybe);
        Ball r(midpoint.hi, midpoint.lo, radius);
        r.undefined_ = u;
        return r;
    }

    static Tri decide_by_sign(const Ball& d, Tri negative, Tri zero, Tri positive) {
        if (!(d.radius_ < HUGE_VAL)) return Tri::unknown;
        if (d.radius_ == 0) return d.hi_ < 0 ? negative : d.hi_ > 0 ? positive : zero;
        const double magnitude = std::fabs(d.hi_) * (1 - 0x1p-50);
        if (magnitude > d.radius_) return d.hi_ < 0 ? negative : positive;
        return Tri::unknown;
    }

    double hi_ = 0, lo_ = 0, radius_ = 0;
    Undefined undefined_ = Undefined::never;
};

// Functions for root searches in enclosures

/// Point in the middle of a ball.
inline Ball middle(const Ball& x) { return {x.hi(), x.lo(), 0}; }
/// Ball that holds all numbers from `low` to `high`.
inline Ball enclose_between(const Ball& low, const Ball& high) {
    const Ball m = middle(Ball(0.5) * (low + high)), upper_half = high - m, lower_half = m - low;
    return {m.hi(), m.lo(),
            (std::fmax(upper_half.hi(), lower_half.hi()) + upper_half.radius() + lower_half.radius()) * (1 + 0x1p-45)};
}
/// Largest magnitude in a ball, as a point.
inline Ball largest_magnitude(const Ball& x) { return Ball((std::fabs(x.hi()) + x.radius()) * (1 + 0x1p-50)); }
/// Number of bits of a ball.
inline int precision_of(const Ball&) { return 100; }

template <>
inline constexpr bool is_exact<Ball> = true;

static_assert(Number<Ball>);

}  // namespace lostbits
