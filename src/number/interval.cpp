#include "number/interval.hpp"

#include <mpfi_io.h>

#include <utility>

namespace lostbits {

thread_local long Interval::working_ = 128;

Interval::Interval() {
    mpfi_init2(value_, working_);
    mpfi_set_ui(value_, 0);
}
Interval::Interval(int x) {
    mpfi_init2(value_, working_);
    mpfi_set_si(value_, x);
}
Interval::Interval(double x) {
    mpfi_init2(value_, working_);
    mpfi_set_d(value_, x);
    settle(Undefined::never);
}
Interval::Interval(const Real& x) {
    mpfi_init2(value_, working_);
    mpfi_set_fr(value_, x.backend().data());
    settle(Undefined::never);
}
Interval::Interval(const Interval& other) : undefined_(other.undefined_) {
    mpfi_init2(value_, mpfi_get_prec(other.value_));
    mpfi_set(value_, other.value_);
}
Interval::Interval(Interval&& other) noexcept : undefined_(other.undefined_) {
    mpfi_init2(value_, MPFR_PREC_MIN);
    mpfi_swap(value_, other.value_);
}
Interval& Interval::operator=(const Interval& other) { return *this = Interval(other); }
Interval& Interval::operator=(Interval&& other) noexcept {
    mpfi_swap(value_, other.value_);
    std::swap(undefined_, other.undefined_);
    return *this;
}
Interval::~Interval() { mpfi_clear(value_); }

Interval Interval::unknown(Undefined u) {
    Interval r;
    mpfr_set_inf(&r.value_->left, -1);
    mpfr_set_inf(&r.value_->right, +1);
    r.undefined_ = u;
    return r;
}

Interval Interval::between(double lower, double upper) {
    Interval r;
    mpfi_interv_d(r.value_, lower, upper);
    return r;
}

// An endpoint that is not a number means that some choice of operands is undefined (∞ − ∞, 0·∞): nothing is known.
void Interval::settle(Undefined u) {
    undefined_ = u;
    if (mpfi_nan_p(value_) != 0) *this = unknown(u == Undefined::always ? u : Undefined::maybe);
    else if (mpfi_bounded_p(value_) == 0 && undefined_ == Undefined::never) undefined_ = Undefined::maybe;
}

Interval operator+(const Interval& a, const Interval& b) {
    Interval r;
    mpfi_add(r.value_, a.value_, b.value_);
    r.settle(spread(a.undefined_, b.undefined_));
    return r;
}
Interval operator-(const Interval& a, const Interval& b) {
    Interval r;
    mpfi_sub(r.value_, a.value_, b.value_);
    r.settle(spread(a.undefined_, b.undefined_));
    return r;
}
Interval operator*(const Interval& a, const Interval& b) {
    Interval r;
    mpfi_mul(r.value_, a.value_, b.value_);
    r.settle(spread(a.undefined_, b.undefined_));
    return r;
}
Interval operator/(const Interval& a, const Interval& b) {
    const Undefined u = spread(a.undefined_, b.undefined_);
    if (mpfi_has_zero(b.value_) > 0) return Interval::unknown(u == Undefined::always ? u : Undefined::maybe);
    Interval r;
    mpfi_div(r.value_, a.value_, b.value_);
    r.settle(u);
    return r;
}
Interval operator-(const Interval& a) {
    Interval r;
    mpfi_neg(r.value_, a.value_);
    r.settle(a.undefined_);
    return r;
}

Tri operator<(const Interval& a, const Interval& b) {
    const Tri verdict = mpfr_less_p(a.upper(), b.lower()) != 0           ? Tri::yes
                        : mpfr_greaterequal_p(a.lower(), b.upper()) != 0 ? Tri::no
                                                                         : Tri::unknown;
    return guarded(verdict, spread(a.undefined_, b.undefined_));
}
Tri operator<=(const Interval& a, const Interval& b) {
    const Tri verdict = mpfr_lessequal_p(a.upper(), b.lower()) != 0 ? Tri::yes
                        : mpfr_greater_p(a.lower(), b.upper()) != 0 ? Tri::no
                                                                    : Tri::unknown;
    return guarded(verdict, spread(a.undefined_, b.undefined_));
}

Interval sqrt(const Interval& a) {
    if (mpfr_sgn(a.upper()) < 0)
        return Interval::unknown(a.undefined_ == Undefined::maybe ? Undefined::maybe : Undefined::always);
    if (mpfr_sgn(a.lower()) >= 0) {
        Interval r;
        mpfi_sqrt(r.value_, a.value_);
        r.settle(a.undefined_);
        return r;
    }
    // The part of the operand where a root exists, and the warning that there may be none.
    Interval r;
    mpfr_set_zero(&r.value_->left, +1);
    mpfr_sqrt(&r.value_->right, a.upper(), MPFR_RNDU);
    r.settle(spread(a.undefined_, Undefined::maybe));
    return r;
}

Interval fma(const Interval& a, const Interval& b, const Interval& c) { return a * b + c; }

Interval square(const Interval& a) {
    Interval r;
    mpfi_sqr(r.value_, a.value_);
    r.settle(a.undefined_);
    return r;
}

Interval abs(const Interval& a) {
    Interval r;
    mpfi_abs(r.value_, a.value_);
    r.settle(a.undefined_);
    return r;
}

Interval middle(const Interval& a) {
    Interval r;
    mpfi_mid(&r.value_->left, a.value_);
    mpfr_set(&r.value_->right, &r.value_->left, MPFR_RNDN);
    r.settle(a.undefined_);
    return r;
}
Interval between(const Interval& low, const Interval& high) {
    Interval r;
    mpfr_set(&r.value_->left, low.lower(), MPFR_RNDD);
    mpfr_set(&r.value_->right, high.upper(), MPFR_RNDU);
    r.settle(spread(low.undefined_, high.undefined_));
    return r;
}
Interval largest(const Interval& a) {
    Interval r;
    mpfi_mag(&r.value_->right, a.value_);
    mpfr_set(&r.value_->left, &r.value_->right, MPFR_RNDN);
    r.settle(a.undefined_);
    return r;
}

// The sign of an exact zero is not a real number's business: a formula that asks for it gets no answer.
Interval copysign(const Interval& a, const Interval& b) {
    if (b.undefined_ != Undefined::never || mpfi_has_zero(b.value_) > 0) return Interval::unknown();
    return mpfi_is_neg(b.value_) > 0 ? -abs(a) : abs(a);
}

Interval select(Tri mask, const Interval& a, const Interval& b) {
    if (!mask.is_unknown()) return mask.is_yes() ? a : b;
    Interval r;
    mpfi_union(r.value_, a.value_, b.value_);
    const bool both = a.undefined_ == Undefined::always && b.undefined_ == Undefined::always;
    const bool neither = a.undefined_ == Undefined::never && b.undefined_ == Undefined::never;
    r.settle(both ? Undefined::always : neither ? Undefined::never : Undefined::maybe);
    return r;
}

}  // namespace lostbits
