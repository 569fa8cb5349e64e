#include "number/interval.hpp"

#include <mpfi_io.h>

#include <cmath>
#include <optional>
#include <utility>

namespace lostbits {

thread_local long Interval::working_bits_ = 128;

namespace {

/// Precision at which MPFI holds every point. From the highest bit of its first double to the lowest bit of its second,
/// a point spans at most 128 + 53 = 181 bits; 192 is the next multiple of 64.
constexpr long point_bits = 192;
constexpr double smallest_low_ratio = 0x1p-128;

/// The sum, if two doubles hold it exactly: no remainder is left when the second doubles are added. Two doubles hold at
/// most 128 + 53 bits, fewer than `point_bits`, so MPFI also computes the sum without loss.
std::optional<DoubleDouble> exact_sum(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = two_sum(a.hi, b.hi);
    DoubleDouble sum = s;
    if (a.lo != 0 || b.lo != 0) {
        const DoubleDouble t = two_sum(a.lo, b.lo), middle_sum = two_sum(s.lo, t.hi);
        const DoubleDouble v = two_sum(s.hi, middle_sum.hi), remainder = two_sum(t.lo, v.lo);
        if (middle_sum.lo != 0 || remainder.lo != 0) return std::nullopt;
        sum = two_sum(v.hi, remainder.hi);
    }
    if (!(std::fabs(sum.hi) <= error_free_high)) return std::nullopt;
    if (sum.lo != 0 && !(std::fabs(sum.lo) >= smallest_low_ratio * std::fabs(sum.hi))) return std::nullopt;
    return sum;
}
DoubleDouble negated(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
/// True if a < b. `hi` is the rounded value of the pair, so unequal `hi` decide the order.
bool is_less(const DoubleDouble& a, const DoubleDouble& b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }

/// The product, if two doubles hold it exactly. Returns nothing if both operands have a second double: such a
/// product has 107 bits or more, and is not tried.
std::optional<DoubleDouble> exact_product(const DoubleDouble& a, const DoubleDouble& b) {
    if (a.hi == 0 || b.hi == 0) return DoubleDouble{0, 0};
    if (a.lo != 0) return b.lo != 0 ? std::nullopt : exact_product(b, a);
    const DoubleDouble first = two_product(a.hi, b.hi);
    if (!residuals_are_exact(first.hi)) return std::nullopt;
    if (b.lo == 0) return first;
    const DoubleDouble second = two_product(a.hi, b.lo);
    return residuals_are_exact(second.hi) ? exact_sum(first, second) : std::nullopt;
}

}  // namespace

Interval::Interval(UninitialisedTag) : bits_(working_bits_), has_ends_(true) { mpfi_init2(value_, working_bits_); }
Interval::Interval() : Interval(0) {}
Interval::Interval(int x) : Interval(static_cast<double>(x)) {}
Interval::Interval(double x) : point_{x, 0}, bits_(working_bits_) {
    is_point_ = working_bits_ >= point_bits && std::fabs(x) <= error_free_high;
    if (is_point_) return;
    ensure_ends();
    set_undefined(Undefined::never);
}
Interval::Interval(mpfr_srcptr x) : Interval(UninitialisedTag()) {
    mpfi_set_fr(value_, x);
    set_undefined(Undefined::never);
}
Interval::Interval(const Interval& other)
    : point_(other.point_), bits_(other.bits_), is_point_(other.is_point_), undefined_(other.undefined_) {
    if (is_point_) return;
    mpfi_init2(value_, bits_);
    mpfi_set(value_, other.value_);
    has_ends_ = true;
}
/// The moved-from interval is left as a point.
Interval::Interval(Interval&& other) noexcept
    : point_(other.point_),
      bits_(other.bits_),
      is_point_(std::exchange(other.is_point_, true)),
      has_ends_(std::exchange(other.has_ends_, false)),
      undefined_(std::exchange(other.undefined_, Undefined::never)) {
    *value_ = *other.value_;
}
Interval& Interval::operator=(const Interval& other) { return *this = Interval(other); }
Interval& Interval::operator=(Interval&& other) noexcept {
    std::swap(*value_, *other.value_);
    std::swap(point_, other.point_);
    std::swap(bits_, other.bits_);
    std::swap(is_point_, other.is_point_);
    std::swap(has_ends_, other.has_ends_);
    std::swap(undefined_, other.undefined_);
    return *this;
}
Interval::~Interval() {
    if (has_ends_) mpfi_clear(value_);
}

bool Interval::can_compute_as_points(const Interval& a, const Interval& b) {
    return a.is_point_ && b.is_point_ && working_bits_ >= point_bits;
}
void Interval::ensure_ends() const {
    mpfi_init2(value_, bits_);
    mpfi_set_d(value_, point_.hi);
    if (point_.lo != 0) mpfi_add_d(value_, value_, point_.lo);
    has_ends_ = true;
}

Interval Interval::all_reals(Undefined u) {
    Interval r{Interval::UninitialisedTag()};
    mpfr_set_inf(&r.value_->left, -1);
    mpfr_set_inf(&r.value_->right, +1);
    r.undefined_ = u;
    return r;
}

Interval Interval::between(double lower, double upper) {
    Interval r{Interval::UninitialisedTag()};
    mpfi_interv_d(r.value_, lower, upper);
    return r;
}

// An endpoint that is NaN means that some choice of operands is undefined (∞ − ∞, 0·∞), so nothing is known.
void Interval::set_undefined(Undefined u) {
    undefined_ = u;
    if (mpfi_nan_p(value_) != 0) *this = all_reals(u == Undefined::always ? u : Undefined::maybe);
    else if (mpfi_bounded_p(value_) == 0 && undefined_ == Undefined::never) undefined_ = Undefined::maybe;
}

Interval operator+(const Interval& a, const Interval& b) {
    if (Interval::can_compute_as_points(a, b))
        if (const auto sum = exact_sum(a.point_, b.point_)) return Interval(*sum);
    Interval r{Interval::UninitialisedTag()};
    mpfi_add(r.value_, a.ends(), b.ends());
    r.set_undefined(combine_undefined(a.undefined_, b.undefined_));
    return r;
}
Interval operator-(const Interval& a, const Interval& b) {
    if (Interval::can_compute_as_points(a, b))
        if (const auto difference = exact_sum(a.point_, negated(b.point_))) return Interval(*difference);
    Interval r{Interval::UninitialisedTag()};
    mpfi_sub(r.value_, a.ends(), b.ends());
    r.set_undefined(combine_undefined(a.undefined_, b.undefined_));
    return r;
}
Interval operator*(const Interval& a, const Interval& b) {
    if (Interval::can_compute_as_points(a, b))
        if (const auto product = exact_product(a.point_, b.point_)) return Interval(*product);
    Interval r{Interval::UninitialisedTag()};
    mpfi_mul(r.value_, a.ends(), b.ends());
    r.set_undefined(combine_undefined(a.undefined_, b.undefined_));
    return r;
}
Interval operator/(const Interval& a, const Interval& b) {
    const Undefined u = combine_undefined(a.undefined_, b.undefined_);
    if (mpfi_has_zero(b.ends()) > 0) return Interval::all_reals(u == Undefined::always ? u : Undefined::maybe);
    Interval r{Interval::UninitialisedTag()};
    mpfi_div(r.value_, a.ends(), b.ends());
    r.set_undefined(u);
    return r;
}
Interval operator-(const Interval& a) {
    if (Interval::can_compute_as_points(a, a)) return Interval(negated(a.point_));
    Interval r{Interval::UninitialisedTag()};
    mpfi_neg(r.value_, a.ends());
    r.set_undefined(a.undefined_);
    return r;
}

Tri operator<(const Interval& a, const Interval& b) {
    if (a.is_point_ && b.is_point_) return Tri(is_less(a.point_, b.point_));
    const Tri verdict = mpfr_less_p(a.upper(), b.lower()) != 0           ? Tri::yes
                        : mpfr_greaterequal_p(a.lower(), b.upper()) != 0 ? Tri::no
                                                                         : Tri::unknown;
    return guard_undefined(verdict, combine_undefined(a.undefined_, b.undefined_));
}
Tri operator<=(const Interval& a, const Interval& b) {
    if (a.is_point_ && b.is_point_) return Tri(!is_less(b.point_, a.point_));
    const Tri verdict = mpfr_lessequal_p(a.upper(), b.lower()) != 0 ? Tri::yes
                        : mpfr_greater_p(a.lower(), b.upper()) != 0 ? Tri::no
                                                                    : Tri::unknown;
    return guard_undefined(verdict, combine_undefined(a.undefined_, b.undefined_));
}

Interval sqrt(const Interval& a) {
    if (mpfr_sgn(a.upper()) < 0)
        return Interval::all_reals(a.undefined_ == Undefined::maybe ? Undefined::maybe : Undefined::always);
    if (mpfr_sgn(a.lower()) >= 0) {
        Interval r{Interval::UninitialisedTag()};
        mpfi_sqrt(r.value_, a.ends());
        r.set_undefined(a.undefined_);
        return r;
    }
    // Encloses the root of the part of the operand that is not negative. The result may be undefined, because the rest
    // of the operand has no root.
    Interval r{Interval::UninitialisedTag()};
    mpfr_set_zero(&r.value_->left, +1);
    mpfr_sqrt(&r.value_->right, a.upper(), MPFR_RNDU);
    r.set_undefined(combine_undefined(a.undefined_, Undefined::maybe));
    return r;
}

Interval fma(const Interval& a, const Interval& b, const Interval& c) { return a * b + c; }

Interval square(const Interval& a) {
    if (Interval::can_compute_as_points(a, a))
        if (const auto product = exact_product(a.point_, a.point_)) return Interval(*product);
    Interval r{Interval::UninitialisedTag()};
    mpfi_sqr(r.value_, a.ends());
    r.set_undefined(a.undefined_);
    return r;
}

Interval abs(const Interval& a) {
    if (Interval::can_compute_as_points(a, a)) return Interval(a.point_.hi < 0 ? negated(a.point_) : a.point_);
    Interval r{Interval::UninitialisedTag()};
    mpfi_abs(r.value_, a.ends());
    r.set_undefined(a.undefined_);
    return r;
}

Interval middle(const Interval& a) {
    Interval r{Interval::UninitialisedTag()};
    mpfi_mid(&r.value_->left, a.ends());
    mpfr_set(&r.value_->right, &r.value_->left, MPFR_RNDN);
    r.set_undefined(a.undefined_);
    return r;
}
Interval enclose_between(const Interval& low, const Interval& high) {
    Interval r{Interval::UninitialisedTag()};
    mpfr_set(&r.value_->left, low.lower(), MPFR_RNDD);
    mpfr_set(&r.value_->right, high.upper(), MPFR_RNDU);
    r.set_undefined(combine_undefined(low.undefined_, high.undefined_));
    return r;
}
Interval largest_magnitude(const Interval& a) {
    Interval r{Interval::UninitialisedTag()};
    mpfi_mag(&r.value_->right, a.ends());
    mpfr_set(&r.value_->left, &r.value_->right, MPFR_RNDN);
    r.set_undefined(a.undefined_);
    return r;
}

// Real numbers do not have signed zeros, so the result is unknown if b may be zero.
Interval copysign(const Interval& a, const Interval& b) {
    if (b.undefined_ != Undefined::never || mpfi_has_zero(b.ends()) > 0) return Interval::all_reals();
    return mpfi_is_neg(b.ends()) > 0 ? -abs(a) : abs(a);
}

Interval select(Tri mask, const Interval& a, const Interval& b) {
    if (!mask.is_unknown()) return mask.is_yes() ? a : b;
    Interval r{Interval::UninitialisedTag()};
    mpfi_union(r.value_, a.ends(), b.ends());
    const bool are_always = a.undefined_ == Undefined::always && b.undefined_ == Undefined::always;
    const bool are_never = a.undefined_ == Undefined::never && b.undefined_ == Undefined::never;
    r.set_undefined(are_always ? Undefined::always : are_never ? Undefined::never : Undefined::maybe);
    return r;
}

}  // namespace lostbits
