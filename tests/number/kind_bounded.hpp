// `Bounded` for the generic test: the value is that of the format, and the exact result for any points that the
// operands may stand for lies within the error.
#pragma once

#include "number/kind.hpp"

namespace lostbits::test {

inline bool surely(const BoundedMask& mask) { return mask.value() && mask.is_proved(); }
inline bool surely_not(const BoundedMask& mask) { return !mask.value() && mask.is_proved(); }

template <class F>
struct Kind<Bounded<F>> {
    using T = Bounded<F>;
    static constexpr bool keeps_zero_signs = true;
    static constexpr int rounds = 30000;

    static FloatFormat format() { return Kind<F>::format(); }
    static double value(const T& x) { return x.value(); }
    static bool is(const T& x, int v) { return x.value() == static_cast<F>(v) && x.error() <= 0x1p-18; }
    static bool is_undefined(const T& x) { return std::isnan(x.value()); }
    struct Setting {
        explicit Setting(Random&) {}
    };
    /// Half of the operands are exact; the points of the others are at their ends, in the middle and between. Errors
    /// are a fraction of the number, or anything. A zero may have an error too, because a product of errors that
    /// underflows is not an exact zero.
    static std::array<Operand<T>, 3> draw(Random& random, Op op) {
        const auto drawn = draw_operands(random, Kind<F>::format(), op);
        const auto operand = [&random](double x) {
            if (random.one_in(2) || !std::isfinite(x)) return Operand<T>{T(static_cast<F>(x)), Mpfr(x, 53)};
            if (random.one_in(10)) x = std::copysign(0.0, x);
            const double part = std::fabs(x) * std::ldexp(random.unit(), -static_cast<int>(random.between(0, 30)));
            const F error = static_cast<F>(random.one_in(2) ? part : std::fabs(draw_finite(random, format())));
            if (error == 0) return Operand<T>{T(static_cast<F>(x)), Mpfr(x, 53)};
            Operand<T> some{T(static_cast<F>(x), error), Mpfr(error, 3000)};
            mpfr_mul_si(some.point, some.point, random.between(-4, 4), MPFR_RNDN);
            mpfr_div_ui(some.point, some.point, 4, MPFR_RNDN);
            mpfr_add_d(some.point, some.point, x, MPFR_RNDN);
            return some;
        };
        return {operand(drawn[0]), operand(drawn[1]), operand(drawn[2])};
    }
    static bool keeps_promise(Op op, const T& result, const std::array<Operand<T>, 3>& x) {
        if (op == Op::copy_sign && std::isnan(x[1].value.value())) return true;
        const auto given = [&x](std::size_t i) { return double{x[i].value.value()}; };
        if (!same_number(double{result.value()},
                         correctly_rounded(op, given(0), given(1), given(2), Kind<F>::format())))
            return false;
        if (!(double{result.error()} < HUGE_VAL)) return true;
        Mpfr exact(3000), apart(3000);
        evaluate(op, exact, {x[0].point, x[1].point, x[2].point}, MPFR_RNDN);
        if (mpfr_number_p(exact) == 0 || !std::isfinite(result.value()))
            return result.error() == 0 && same_number(double{result.value()}, mpfr_get_d(exact, MPFR_RNDN));
        mpfr_sub_d(apart, exact, double{result.value()}, MPFR_RNDZ);
        return mpfr_cmpabs(apart, Mpfr(result.error(), 53)) <= 0;
    }
    static std::string text(const T& x) { return Mpfr(x.value(), 53).text() + " ± " + Mpfr(x.error(), 53).text(); }
};

}  // namespace lostbits::test
