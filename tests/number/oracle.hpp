// Expected result of an operation, independent of src/number: MPFR at the width in question, with the exponent range
// and the subnormals of the format.
#pragma once

#include <mpfr.h>

#include <cmath>
#include <string>

#include "number/concept.hpp"
#include "number/format.hpp"

namespace lostbits::test {

/// An MPFR number with value semantics.
class Mpfr {
public:
    explicit Mpfr(long bits) { mpfr_init2(x_, bits); }
    Mpfr(double value, long bits) : Mpfr(bits) { mpfr_set_d(x_, value, MPFR_RNDN); }
    Mpfr(const Mpfr& other) : Mpfr(mpfr_get_prec(other.x_)) { mpfr_set(x_, other.x_, MPFR_RNDN); }
    Mpfr& operator=(const Mpfr& other) {
        mpfr_set_prec(x_, mpfr_get_prec(other.x_));
        mpfr_set(x_, other.x_, MPFR_RNDN);
        return *this;
    }
    ~Mpfr() { mpfr_clear(x_); }
    operator mpfr_ptr() { return x_; }
    operator mpfr_srcptr() const { return x_; }
    [[nodiscard]] std::string text() const {
        char buffer[160];
        mpfr_snprintf(buffer, sizeof buffer, "%Ra (prec %ld)", x_, static_cast<long>(mpfr_get_prec(x_)));
        return buffer;
    }

private:
    mpfr_t x_;
};

/// Everything a formula may do to numbers. `choose` is select(a < b, b, c).
enum class Op {
    add,
    subtract,
    multiply,
    divide,
    root,
    fused,
    negate,
    absolute,
    copy_sign,
    minimum,
    maximum,
    choose,
    square,
    fused_square
};
inline constexpr Op every_op[] = {Op::add,     Op::subtract, Op::multiply, Op::divide,      Op::root,
                                  Op::fused,   Op::negate,   Op::absolute, Op::copy_sign,   Op::minimum,
                                  Op::maximum, Op::choose,   Op::square,   Op::fused_square};
inline constexpr const char* op_names[] = {"a + b",          "a - b",           "a * b",     "a / b",
                                           "sqrt(a)",        "fma(a, b, c)",    "-a",        "abs(a)",
                                           "copysign(a, b)", "min(a, b)",       "max(a, b)", "select(a < b, b, c)",
                                           "square(a)",      "fma_square(a, c)"};

/// The operation over any number, as formulas write it.
template <class T>
T apply(Op op, const T& a, const T& b, const T& c) {
    switch (op) {
        case Op::add: return a + b;
        case Op::subtract: return a - b;
        case Op::multiply: return a * b;
        case Op::divide: return a / b;
        case Op::root: return sqrt(a);
        case Op::fused: return fma(a, b, c);
        case Op::negate: return -a;
        case Op::absolute: return abs(a);
        case Op::copy_sign: return copysign(a, b);
        case Op::minimum: return min(a, b);
        case Op::maximum: return max(a, b);
        case Op::choose: return select(a < b, b, c);
        case Op::square: return square(a);
        case Op::fused_square: return fma_square(a, c);
    }
    return a;
}

/// The exact values of operands.
struct Points {
    const Mpfr &a, &b, &c;
};

/// The same in MPFR: the exact result rounded once to the precision of `out`. Returns MPFR's ternary value.
inline int evaluate(Op op, Mpfr& out, const Points& x, mpfr_rnd_t round) {
    const auto& [a, b, c] = x;
    switch (op) {
        case Op::add: return mpfr_add(out, a, b, round);
        case Op::subtract: return mpfr_sub(out, a, b, round);
        case Op::multiply: return mpfr_mul(out, a, b, round);
        case Op::divide: return mpfr_div(out, a, b, round);
        case Op::root: return mpfr_sqrt(out, a, round);
        case Op::fused: return mpfr_fma(out, a, b, c, round);
        case Op::negate: return mpfr_neg(out, a, round);
        case Op::absolute: return mpfr_abs(out, a, round);
        case Op::copy_sign: return mpfr_nan_p(b) ? mpfr_set(out, b, round) : mpfr_copysign(out, a, b, round);
        case Op::minimum: return mpfr_set(out, mpfr_less_p(a, b) ? a : b, round);
        case Op::maximum: return mpfr_set(out, mpfr_greater_p(a, b) ? a : b, round);
        case Op::choose: return mpfr_set(out, mpfr_less_p(a, b) ? b : c, round);
        case Op::square: return mpfr_sqr(out, a, round);
        case Op::fused_square: return mpfr_fma(out, a, a, c, round);
    }
    return 0;
}

/// MPFR's exponent range for the lifetime of the scope. Its significands lie in [1/2, 1): exponents are one higher.
class ExponentRange {
public:
    explicit ExponentRange(const FloatFormat& format) : low_(mpfr_get_emin()), high_(mpfr_get_emax()) {
        mpfr_set_emin(format.emin - format.precision + 2);
        mpfr_set_emax(format.emax + 1);
    }
    ~ExponentRange() {
        mpfr_set_emin(low_);
        mpfr_set_emax(high_);
    }
    ExponentRange(const ExponentRange&) = delete;
    ExponentRange& operator=(const ExponentRange&) = delete;

private:
    mpfr_exp_t low_, high_;
};

/// The exact result rounded once, to nearest even, into the format. Operands are numbers of the format.
inline double correctly_rounded(Op op, const Mpfr& a, const Mpfr& b, const Mpfr& c, const FloatFormat& format) {
    const ExponentRange range(format);
    Mpfr r(format.precision);
    const int inexact = evaluate(op, r, {a, b, c}, MPFR_RNDN);
    mpfr_subnormalize(r, inexact, MPFR_RNDN);
    return mpfr_get_d(r, MPFR_RNDN);
}

inline double correctly_rounded(Op op, double a, double b, double c, const FloatFormat& format) {
    return correctly_rounded(op, Mpfr(a, 53), Mpfr(b, 53), Mpfr(c, 53), format);
}

/// Any MPFR number rounded once into the format.
inline double nearest(const Mpfr& x, const FloatFormat& format) {
    const ExponentRange range(format);
    Mpfr r(format.precision);
    const int inexact = mpfr_set(r, x, MPFR_RNDN);
    const int checked = mpfr_check_range(r, inexact, MPFR_RNDN);
    mpfr_subnormalize(r, checked, MPFR_RNDN);
    return mpfr_get_d(r, MPFR_RNDN);
}

/// Equal as numbers that a program can tell apart: signed zeros differ, all NaN are one.
inline bool same_number(double x, double y) {
    return (std::isnan(x) && std::isnan(y)) || (x == y && std::signbit(x) == std::signbit(y));
}

}  // namespace lostbits::test
