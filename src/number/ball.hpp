// Ball: what is certainly true, at about 100 bits and at the price of a few dozen double operations.
// Midpoint in double-double, radius in double. It answers most rays; where it cannot, `Interval` does.
#pragma once

#include "number/concept.hpp"
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
        if (a.lo_ == 0 && b.lo_ == 0) {  // the sum of two doubles is a double-double, exactly
            const double s = a.hi_ + b.hi_;
            const double bb = s - a.hi_;
            const double e = (a.hi_ - (s - bb)) + (b.hi_ - bb);
            return finish(s, e, a.radius_ + b.radius_, false, a, b);
        }
        const double sh = a.hi_ + b.hi_;
        const double sb = sh - a.hi_;
        const double sl = (a.hi_ - (sh - sb)) + (b.hi_ - sb);
        const double th = a.lo_ + b.lo_;
        const double tb = th - a.lo_;
        const double tl = (a.lo_ - (th - tb)) + (b.lo_ - tb);
        const double c = sl + th;
        const double vh = sh + c;
        const double w = tl + (c - (vh - sh));
        const double hi = vh + w;
        return finish(hi, w - (hi - vh), a.radius_ + b.radius_, true, a, b);
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
        const double ph = a.hi_ * b.hi_;
        double pl = std::fma(a.hi_, b.hi_, -ph);
        const double spread = std::fabs(a.hi_) * b.radius_ + std::fabs(b.hi_) * a.radius_ + a.radius_ * b.radius_;
        const bool one_word = a.lo_ == 0 && b.lo_ == 0;
        if (one_word) return in_range(ph) ? finish(ph, pl, spread, false, a, b) : unknown();
        pl += std::fma(a.hi_, b.lo_, a.lo_ * b.hi_);
        const double hi = ph + pl;
        // A midpoint of zero inside a wide ball is a legitimate factor: only its radius counts.
        if (!in_range(hi) && !(a.hi_ == 0 || b.hi_ == 0)) return unknown();
        return finish(hi, pl - (hi - ph), spread, true, a, b);
    }
    friend Ball operator/(const Ball& a, const Ball& b) {
        const double distance_from_zero = std::fabs(b.hi_) * (1 - 0x1p-50) - b.radius_;
        if (!(distance_from_zero > 0)) return unknown();
        if (a.is_zero()) return a.is_bounded() && b.is_bounded() ? Ball(0) : unknown();
        const double qh = a.hi_ / b.hi_;
        if (!in_range(qh) || !in_range(a.hi_)) return unknown();
        // r = a − qh·b, which is small enough to be a double-double again.
        const double rh = std::fma(-qh, b.hi_, a.hi_);
        const double ql = (rh + (a.lo_ - qh * b.lo_)) / b.hi_;
        const double hi = qh + ql;
        const double spread = (a.radius_ + (std::fabs(qh) * (1 + 0x1p-50)) * b.radius_) / distance_from_zero;
        return finish(hi, ql - (hi - qh), spread, true, a, b);
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
        const double sl = (a.lo_ + std::fma(-sh, sh, a.hi_)) / (2 * sh);
        const double hi = sh + sl;
        // |√x − √a| = |x − a|/(√x + √a) ≤ radius/√a
        return finish(hi, sl - (hi - sh), a.radius_ / (sh * (1 - 0x1p-50)), true, a, a);
    }
    friend Ball fma(const Ball& a, const Ball& b, const Ball& c) { return a * b + c; }
    friend Ball abs(const Ball& a) {
        if (!a.is_bounded()) return a;
        return a.hi_ < 0 ? -a : a;  // | |x| − |m| | ≤ |x − m|
    }
    friend Ball copysign(const Ball& a, const Ball& b) {
        const Tri negative = b < Ball(0);
        // `negative` is a plain no where b is NaN for certain, and NaN's sign is anyone's.
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
    /// A ball around both sides where the mask is undecided: with the midpoint of a, its radius is
    /// |b − a| + radius(a) + radius(b), which holds the points of either.
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

    static bool in_range(double x) { return std::fabs(x) >= 0x1p-900 && std::fabs(x) <= 0x1p+900; }
    [[nodiscard]] bool is_zero() const { return hi_ == 0 && radius_ == 0; }
    static Undefined either(const Ball& a, const Ball& b) { return spread(a.undefined_, b.undefined_); }

    static Ball finish(double hi, double lo, double spread, bool rounded, const Ball& a, const Ball& b) {
        const bool exact = !rounded && a.radius_ == 0 && b.radius_ == 0;
        if (!exact) spread = (spread + std::fabs(hi) * dd_error) * inflate + smallest_radius;
        const Undefined u = either(a, b);
        if (!(std::fabs(hi) <= 0x1p+900) || !(spread < HUGE_VAL))
            return unknown(u == Undefined::always ? u : Undefined::maybe);
        Ball r(hi, lo, spread);
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

template <>
inline constexpr bool stands_for_exact<Ball> = true;

static_assert(Number<Ball>);

}  // namespace lostbits
