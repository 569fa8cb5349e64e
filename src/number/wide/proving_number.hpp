// ProvingNumber: a number of a formula together with a bound on its rounding error, both in the formula's own format. A
// filter decides a comparison if the bounds of both numbers prove it.
#pragma once

#include "number/tri.hpp"
#include "number/wide/widening.hpp"

namespace lostbits::number::wide {

/// Unit roundoff u of a format.
template <class P>
P roundoff() {
    if constexpr (InRegisters<P>) return P(has_wider_word<P> ? 0x1p-24 : 0x1p-53);
    else return unit_roundoff<P>();
}
/// Factor 1 + 2^-9 by which the bound of a comparison is enlarged.
template <class P>
P outward_factor() {
    if constexpr (InRegisters<P>) return P(1 + 0x1p-9);
    else return P(513) / P(512);
}

/// A word w of T and a bound e of P. T's own operations compute w, so it has the same bits as in T, and T records it in
/// the same way. P is T without recording. The pair encloses all real x with |x − w| ≤ e (1 + 2^-10), for formats with
/// 2^20 u ≤ 1. If e is infinite or NaN, nothing is known about x, and no comparison with it is decided.
///
/// Let x and y be the exact values that a and b enclose, w the rounded result, η the least subnormal number, and L the
/// least normal one:
///
///     w = a ± b    |x ± y − w| ≤ e_a + e_b + u|w|                     (a sum does not underflow)
///     w = a b      |x y − w|   ≤ (|a| + e_a) e_b + |b| e_a + u|w| + η
///     w = a/b      |x/y − w|   ≤ (e_a + (|w| + η) e_b)/(|b| − e_b) (1 + 2u) + u|w| + η
///     w = √a       |√x − w|    ≤ e_a/√a + u|w|
///
/// Nothing is known about a quotient if |b| ≤ e_b, nor about a root if a ≤ e_a. The bounds are rounded too:
///
/// - A product or quotient in a bound can lose an η, so L, which is at least 4η, is added for each.
/// - Each step of a bound loses a factor of at most 1 + 2u. No formula here has 400 such steps one after the other, and
///   (1 + 2u)^400 < 1 + 2^-10.
/// - The only subtraction is |b| − e_b, with e_b rounded up.
/// - If a word overflows, u|w| is infinite or NaN.
///
/// A comparison uses d, the rounded difference, which has the sign of the exact difference. Its bound is
/// e = (e_a + e_b)(1 + 2^-9), which covers the factor 1 + 2^-10 and the rounding u|d| of d itself.
template <class T>
class ProvingNumber {
public:
    using P = decltype(plain_value(std::declval<const T&>()));
    using Lanes = mask_t<P>;
    using Mask = TriMask<Lanes>;

    explicit ProvingNumber(std::same_as<int> auto x) : w_(T(x)), e_(0) {}
    /// An input: exact.
    explicit ProvingNumber(const T& w) : w_(w), e_(0) {}
    ProvingNumber(const T& w, const P& e) : w_(w), e_(e) {}

    [[nodiscard]] const T& word() const { return w_; }
    /// Upper bound on the distance from the word to any enclosed x.
    [[nodiscard]] P radius() const { return e_ * outward_factor<P>(); }
    /// True if the word is positive; x itself may have the other sign.
    [[nodiscard]] Mask is_roughly_positive() const {
        const Lanes is_positive = plain_value(w_) > P(0);
        return {is_positive, !is_positive};
    }

    friend ProvingNumber operator+(const ProvingNumber& a, const ProvingNumber& b) {
        return with_rounding_error(a.w_ + b.w_, a.e_ + b.e_);
    }
    friend ProvingNumber operator-(const ProvingNumber& a, const ProvingNumber& b) {
        return with_rounding_error(a.w_ - b.w_, a.e_ + b.e_);
    }
    friend ProvingNumber operator-(const ProvingNumber& a) { return {-a.w_, a.e_}; }
    friend ProvingNumber operator*(const ProvingNumber& a, const ProvingNumber& b) {
        return with_rounding_error(a.w_ * b.w_,
                                   (a.magnitude() + a.e_) * b.e_ + b.magnitude() * a.e_ + smallest_normal<P>());
    }
    friend ProvingNumber operator/(const ProvingNumber& a, const ProvingNumber& b) {
        using lostbits::select;
        const ProvingNumber q = with_rounding_error(a.w_ / b.w_, smallest_normal<P>());
        const P min_divisor = b.magnitude() - b.radius(), underflow_loss = smallest_normal<P>();
        const P propagated_error = (a.e_ + (q.magnitude() + underflow_loss) * b.e_ + underflow_loss) / min_divisor;
        return {q.w_, select(min_divisor > P(0), q.e_ + propagated_error, P(1) / P(0))};
    }
    ProvingNumber& operator+=(const ProvingNumber& b) { return *this = *this + b; }
    ProvingNumber& operator-=(const ProvingNumber& b) { return *this = *this - b; }
    ProvingNumber& operator*=(const ProvingNumber& b) { return *this = *this * b; }

    friend Mask operator<(const ProvingNumber& a, const ProvingNumber& b) {
        const P d = plain_value(a.w_) - plain_value(b.w_), e = (a.e_ + b.e_) * outward_factor<P>();
        return {d<-e, d> e};
    }
    friend Mask operator<=(const ProvingNumber& a, const ProvingNumber& b) { return a < b; }
    friend Mask operator>(const ProvingNumber& a, const ProvingNumber& b) { return b < a; }
    friend Mask operator>=(const ProvingNumber& a, const ProvingNumber& b) { return b < a; }

    friend ProvingNumber sqrt(const ProvingNumber& a) {
        using lostbits::sqrt, lostbits::select;
        const ProvingNumber root = with_rounding_error(sqrt(a.w_), P(0));
        const P propagated_error = (a.e_ + smallest_normal<P>()) / plain_value(root.w_);
        return {root.w_, select(plain_value(a.w_) > a.radius(), root.e_ + propagated_error, P(1) / P(0))};
    }
    friend ProvingNumber fma(const ProvingNumber& a, const ProvingNumber& b, const ProvingNumber& c) {
        return a * b + c;
    }
    /// Returns the number itself: the pair encloses real numbers, which have no neighbours.
    friend ProvingNumber next_up(const ProvingNumber& a) { return a; }
    friend ProvingNumber next_down(const ProvingNumber& a) { return a; }
    friend ProvingNumber abs(const ProvingNumber& a) {
        using lostbits::abs;
        return {abs(a.w_), a.e_};
    }
    friend ProvingNumber copysign(const ProvingNumber& a, const ProvingNumber& b) {
        const ProvingNumber x = abs(a);
        return select(b < ProvingNumber(0), -x, x);
    }
    /// If the mask is undecided, the result is b with an infinite bound.
    friend ProvingNumber select(const Mask& mask, const ProvingNumber& a, const ProvingNumber& b) {
        using lostbits::select;
        return {select(constant_mask<T>(mask.yes()), a.w_, b.w_),
                select(mask.yes(), a.e_, select(mask.no(), b.e_, P(1) / P(0)))};
    }

private:
    [[nodiscard]] P magnitude() const {
        using lostbits::abs;
        return abs(plain_value(w_));
    }
    static ProvingNumber with_rounding_error(const T& w, const P& propagated_error) {
        using lostbits::abs;
        return {w, propagated_error + roundoff<P>() * abs(plain_value(w))};
    }

    T w_;
    P e_;
};

static_assert(Number<ProvingNumber<float>> && Number<ProvingNumber<double>>);

}  // namespace lostbits::number::wide
