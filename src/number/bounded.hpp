// Bounded: a number of a format and a bound on its error in the same format, computed by running error analysis.
#pragma once

#include <limits>
#include <span>

#include "number/concept.hpp"

namespace lostbits {

/// A decision that the values make, and whether the bounds prove it.
class BoundedMask : public NotABool {
public:
    constexpr BoundedMask(bool value, bool proved) : value_(value), proved_(proved) {}
    [[nodiscard]] constexpr bool value() const { return value_; }
    [[nodiscard]] constexpr bool is_proved() const { return proved_; }

    /// A proved false operand proves that the conjunction is false, whatever the other operand is.
    friend constexpr BoundedMask operator&&(const BoundedMask& a, const BoundedMask& b) {
        return {a.value_ && b.value_, (a.proved_ && b.proved_) || (a.proved_ && !a.value_) || (b.proved_ && !b.value_)};
    }
    friend constexpr BoundedMask operator!(const BoundedMask& a) { return {!a.value_, a.proved_}; }
    friend constexpr BoundedMask operator||(const BoundedMask& a, const BoundedMask& b) { return !(!a && !b); }
    /// True if a loop must go on, or if a branch that `select` may join must be taken. This is so if the values decide
    /// it, or if the decision without rounding may differ because it is not proved.
    friend constexpr bool any_of(const BoundedMask& a) { return a.value_ || !a.proved_; }

private:
    bool value_, proved_;
};

/// A value of F, with the bits that F computes, and `error`, a number of F. The same formula in exact arithmetic on the
/// same inputs gives a number within `error` of the value (running error analysis; Higham, Accuracy and Stability of
/// Numerical Algorithms, 2002, section 3.3). An error of infinity means that nothing is known. An error of zero means
/// that the value is exact, even if it is infinite or NaN.
///
/// The rounding error of a sum is known exactly, and so is that of a product that does not underflow (see
/// error_free.hpp). The rounding error of any other operation is at most u|v| plus the smallest subnormal number. The
/// bound is computed from the rounded v, hence u(1 + u). The bounds are sums of products of at most seven operations in
/// a row, each of which rounds. The factor 1 + 16u makes up for their relative loss, as (1 − u)^7 (1 + 16u) ≥ 1 for
/// every u ≤ 1/8. Each product loses less than half of the smallest subnormal number η to underflow; sums lose nothing
/// there. There are at most three such products and the one of `round_outward` itself: four η exceed their loss. So
/// `round_outward(B)` is never below B. Its argument must not be a zero that stands for a larger number: a bound is
/// zero only if its operands are exact (`is_exact_zero`, or errors of zero), never because a product of errors
/// underflowed. A bound of NaN means that nothing is known, as infinity does.
///
/// If a decision is not proved, `select` returns the operand that the values select, as F does, and its error covers
/// the other operand too.
template <class F>
class Bounded {
public:
    explicit Bounded(int x) : value_(static_cast<F>(x)) {}
    /// An input: exact.
    template <std::floating_point X>
    explicit Bounded(X x) : value_(static_cast<F>(x)) {}
    Bounded(F value, F error) : value_(value), error_(error >= 0 ? error : infinity) {}

    [[nodiscard]] F value() const { return value_; }
    [[nodiscard]] F error() const { return error_; }

    friend Bounded operator-(const Bounded& a) { return {-a.value_, a.error_}; }
    friend Bounded operator+(const Bounded& a, const Bounded& b) {
        const F v = a.value_ + b.value_;
        if (a.is_exact_infinity() || b.is_exact_infinity()) return sum_or_product_with_infinity(v, a, b);
        const F bb = v - a.value_, rounding_error = (a.value_ - (v - bb)) + (b.value_ - bb);
        return with_rounding_error(v, a.error_ + b.error_, magnitude(rounding_error), a, b);
    }
    friend Bounded operator-(const Bounded& a, const Bounded& b) { return a + (-b); }
    /// |ab − a*b*| ≤ |a| δb + |b| δa + δa δb, which is zero only if both factors are exact or one is an exact zero.
    friend Bounded operator*(const Bounded& a, const Bounded& b) {
        const F v = a.value_ * b.value_;
        if (a.is_exact_infinity() || b.is_exact_infinity())
            return a.has_sign() && b.has_sign() ? sum_or_product_with_infinity(v, a, b) : unknown(v);
        const F rounding_error = a.value_ == 0 || b.value_ == 0          ? F(0)
                                 : magnitude(v) < smallest_exact_product ? rounding_bound(v)
                                                                         : magnitude(fma(a.value_, b.value_, -v));
        const bool has_propagated_error = (a.error_ > 0 || b.error_ > 0) && !a.is_exact_zero() && !b.is_exact_zero();
        const F propagated_error = magnitude(a) * b.error_ + magnitude(b) * a.error_ + a.error_ * b.error_;
        return with_rounding_error(v, has_propagated_error ? propagated_error + smallest_subnormal : propagated_error,
                                   rounding_error, a, b);
    }
    /// |a/b − a*/b*| ≤ (δa + |a/b| δb)/(|b| − δb).
    friend Bounded operator/(const Bounded& a, const Bounded& b) {
        const F v = a.value_ / b.value_;
        if (b.is_exact_zero()) return a.has_sign() ? Bounded(v, 0) : unknown(v);
        if (b.is_exact_infinity()) return a.error_ < infinity && !a.is_exact_infinity() ? Bounded(v, 0) : unknown(v);
        if (a.is_exact_infinity()) return b.has_sign() ? Bounded(v, 0) : unknown(v);
        const F min_divisor = magnitude(b) * (1 - 4 * u) - b.error_;
        if (!(min_divisor > 0)) return unknown(v);
        if (a.is_exact_zero()) return {v, 0};
        // The underflow loss of a product is added before the division, because the divisor may be small.
        const F numerator = a.error_ + (magnitude(v) + smallest_subnormal) * b.error_ +
                            (a.error_ > 0 || b.error_ > 0 ? smallest_subnormal : F(0));
        return with_rounding_error(v, numerator / min_divisor, rounding_bound(v), a, b);
    }
    Bounded& operator+=(const Bounded& b) { return *this = *this + b; }
    Bounded& operator-=(const Bounded& b) { return *this = *this - b; }
    Bounded& operator*=(const Bounded& b) { return *this = *this * b; }

    /// |√a − √a*| ≤ δa/(√a + √(a − δa)). The bound is infinite if a* may be negative.
    friend Bounded sqrt(const Bounded& a) {
        const F v = sqrt(a.value_);
        if (a.is_exact_zero() || a.is_exact_infinity()) return {v, 0};
        if (a.error_ == 0 && a.value_ < 0) return {v, 0};  // NaN in any arithmetic
        const F min_radicand = a.value_ * (1 - 4 * u) - a.error_;
        if (a.error_ > 0 && !(min_radicand >= 0)) return unknown(v);
        return with_rounding_error(v, a.error_ == 0 ? F(0) : a.error_ / (v + sqrt(min_radicand) * (1 - 4 * u)),
                                   rounding_bound(v), a, a);
    }
    friend Bounded fma(const Bounded& a, const Bounded& b, const Bounded& c) {
        const F v = fma(a.value_, b.value_, c.value_);
        if (a.is_infinite() || b.is_infinite() || c.is_infinite()) return unknown(v);
        const F propagated_error = magnitude(a) * b.error_ + magnitude(b) * a.error_ + a.error_ * b.error_ + c.error_;
        return c.is_nan() ? unknown(v) : with_rounding_error(v, propagated_error, rounding_bound(v), a, b);
    }
    friend Bounded abs(const Bounded& a) { return {magnitude(a), a.error_}; }
    friend Bounded copysign(const Bounded& a, const Bounded& b) {
        const F v = copysign(a.value_, b.value_);
        if (b.is_nan() || !b.has_sign_bit()) return {v, round_outward(2 * magnitude(a) + a.error_)};
        return {v, a.error_};
    }
    /// The next number of F. In exact arithmetic a number has no neighbours.
    friend Bounded next_up(const Bounded& a) {
        const F v = next_up(a.value_);
        return v == a.value_ || a.is_nan() ? Bounded(v, a.error_)
                                           : Bounded(v, round_outward(a.error_ + (v - a.value_)));
    }
    friend Bounded next_down(const Bounded& a) { return -next_up(-a); }
    /// The result of min or max moves by at most the larger of the errors of the operands.
    friend Bounded min(const Bounded& a, const Bounded& b) { return extremum(a < b, a, b); }
    friend Bounded max(const Bounded& a, const Bounded& b) { return extremum(a > b, a, b); }
    friend Bounded select(const BoundedMask& mask, const Bounded& a, const Bounded& b) {
        const Bounded &chosen = mask.value() ? a : b, &other = mask.value() ? b : a;
        if (mask.is_proved() || is_same(a, b)) return chosen;
        if (chosen.is_infinite() || other.is_infinite() || chosen.is_nan() || other.is_nan())
            return unknown(chosen.value_);
        const F error_of_other = round_outward(magnitude(chosen.value_ - other.value_) + other.error_);
        return {chosen.value_, error_of_other > chosen.error_ ? error_of_other : chosen.error_};
    }

    friend BoundedMask operator<(const Bounded& a, const Bounded& b) {
        return {a.value_ < b.value_, is_comparison_proved(a, b)};
    }
    friend BoundedMask operator<=(const Bounded& a, const Bounded& b) {
        return {a.value_ <= b.value_, is_comparison_proved(a, b)};
    }
    friend BoundedMask operator>(const Bounded& a, const Bounded& b) { return b < a; }
    friend BoundedMask operator>=(const Bounded& a, const Bounded& b) { return b <= a; }

    /// Result of a call, whose error is known only if the arguments are exact, because its dependence on them is not
    /// known.
    friend Bounded call_result(const Call& callee, std::span<const Bounded> arguments, F value) {
        for (const Bounded& a : arguments)
            if (a.error_ != 0) return unknown(value);
        if (callee.answer == CallAnswer::decision) return {value, 0};
        return abs(value) < infinity ? Bounded(value, round_outward(16 * u * magnitude(value))) : unknown(value);
    }

    /// The same number in a wider or a narrower format.
    template <class To>
    [[nodiscard]] Bounded<To> converted() const {
        const To v = static_cast<To>(value_);
        if (error_ == 0 && (v == value_ || is_nan())) return {v, To(0)};
        if (!(error_ < infinity) || is_infinite()) return Bounded<To>::unknown(v);
        const F rounding_error = static_cast<F>(v) - value_;  // F holds every number of a narrower To
        return {
            v, Bounded<To>::round_outward(next_up(static_cast<To>(round_outward(error_ + magnitude(rounding_error)))))};
    }

private:
    template <class>
    friend class Bounded;

    static constexpr F infinity = std::numeric_limits<F>::infinity();
    static constexpr F u = std::numeric_limits<F>::epsilon() / 2,
                       smallest_subnormal = std::numeric_limits<F>::denorm_min();

    static F magnitude(F x) { return abs(x); }
    static F magnitude(const Bounded& a) { return abs(a.value_); }
    /// Smallest magnitude at which the rounding error of a product is a number of the format.
    static constexpr F smallest_exact_product = std::numeric_limits<F>::min() / (u * u);
    static F round_outward(F bound) { return bound * (1 + 16 * u) + 4 * smallest_subnormal; }
    /// Largest possible rounding error of an operation with the result v, if v is the nearest number.
    static F rounding_bound(F v) { return u * magnitude(v) + smallest_subnormal; }
    static Bounded unknown(F v) { return {v, infinity}; }
    static bool is_same(const Bounded& a, const Bounded& b) { return a.value_ == b.value_ && a.error_ == b.error_; }

    [[nodiscard]] bool is_nan() const { return !(value_ == value_); }
    [[nodiscard]] bool is_infinite() const { return abs(value_) >= infinity; }
    [[nodiscard]] bool is_exact_infinity() const { return is_infinite() && error_ == 0; }
    [[nodiscard]] bool is_exact_zero() const { return value_ == 0 && error_ == 0; }
    /// True if the exact number is known to be above or below zero.
    [[nodiscard]] bool has_sign() const { return abs(value_) > error_; }
    /// True if the sign is known, including the sign of an exact zero.
    [[nodiscard]] bool has_sign_bit() const { return has_sign() || is_exact_zero(); }

    /// Sum or product with an exact infinity as an operand. The result is known if both bounds are finite: an infinity
    /// if the other operand is finite or an infinity that agrees, otherwise NaN.
    static Bounded sum_or_product_with_infinity(F v, const Bounded& a, const Bounded& b) {
        const bool are_finite_bounds = a.error_ < infinity && b.error_ < infinity;
        return are_finite_bounds ? Bounded(v, 0) : unknown(v);
    }
    static Bounded with_rounding_error(F v, F propagated_error, F rounding_error, const Bounded& a, const Bounded& b) {
        if (a.error_ == 0 && b.error_ == 0 && (a.is_nan() || b.is_nan())) return {v, 0};
        if (!(propagated_error < infinity) || !(abs(v) < infinity)) return unknown(v);
        return {v,
                propagated_error == 0 && rounding_error == 0 ? F(0) : round_outward(propagated_error + rounding_error)};
    }
    /// min and max are computed as a < b ? a : b, which yields the second operand if either is NaN. With a NaN, the
    /// result is known only if the decision is proved.
    static Bounded extremum(const BoundedMask& takes_first, const Bounded& a, const Bounded& b) {
        const Bounded& chosen = takes_first.value() ? a : b;
        if (takes_first.is_proved()) return chosen;
        if (a.is_nan() || b.is_nan()) return unknown(chosen.value_);
        return {chosen.value_, a.error_ > b.error_ ? a.error_ : b.error_};
    }
    /// True if a comparison of the values also holds for the exact numbers: either the values are exact, or the
    /// distance between them exceeds the sum of their errors. Every comparison with a NaN is false.
    static bool is_comparison_proved(const Bounded& a, const Bounded& b) {
        if (a.error_ == 0 && b.error_ == 0) return true;
        if ((a.is_nan() && a.error_ == 0) || (b.is_nan() && b.error_ == 0)) return true;
        if (!(a.error_ < infinity) || !(b.error_ < infinity)) return false;
        // An exact infinity differs from every other number, even if the outward bounds are infinite too.
        if (a.is_exact_infinity() || b.is_exact_infinity()) return true;
        return abs(a.value_ - b.value_) * (1 - 4 * u) > round_outward(a.error_ + b.error_);
    }

    F value_;
    F error_ = 0;
};

template <>
struct Wider<Bounded<float>> {
    using type = Bounded<double>;
    static type widen(const Bounded<float>& x) { return x.converted<double>(); }
    static Bounded<float> narrow(const type& x) { return x.converted<float>(); }
};

template <class F>
inline constexpr bool traces_operations<Bounded<F>> = true;

static_assert(Number<Bounded<float>> && Number<Bounded<double>>);

}  // namespace lostbits
