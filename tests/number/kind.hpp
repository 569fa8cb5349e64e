// Properties of a number type that the generic test needs: how operands are drawn, which exact reals they stand for,
// and when a result keeps the promise of the type. One specialisation serves several similar types.
#pragma once

#include <memory>
#include <stdexcept>

#include "number/draw.hpp"
#include "number/kinds.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::test {

inline bool surely(bool mask) { return mask; }
inline bool surely(Tri mask) { return mask.is_yes(); }
inline bool surely_not(bool mask) { return !mask; }
inline bool surely_not(Tri mask) { return mask.is_no(); }
inline bool surely(const RecordedMask& mask) { return mask.value(); }
inline bool surely_not(const RecordedMask& mask) { return !mask.value(); }

/// For a pack: true in every lane, or in none.
template <class F, class Width>
bool surely(const PackMask<F, Width>& mask) {
    return !any_of(!mask);
}
template <class F, class Width>
bool surely_not(const PackMask<F, Width>& mask) {
    return !any_of(mask);
}

/// A number, and an exact value that it may stand for (NaN: undefined).
template <class T>
struct Operand {
    T value;
    Mpfr point;
};

template <class T>
struct Kind;

// --- floating-point formats: the result is the exact one, rounded once --------------------------------------------

template <class T>
inline constexpr bool is_pack = false;
template <class F, class Width>
inline constexpr bool is_pack<Pack<F, Width>> = true;

/// Value of every lane, which must be the same. test_pack.cpp looks at lanes that differ.
template <class F, class Width>
double in_every_lane(const Pack<F, Width>& x) {
    F lanes[Pack<F, Width>::lanes];
    x.store(lanes);
    for (const F lane : lanes)
        if (!same_number(lane, lanes[0])) throw std::logic_error("lanes that were given the same numbers differ");
    return lanes[0];
}

template <class T>
concept InFormat =
    std::same_as<T, float> || std::same_as<T, double> || std::same_as<T, Dual<double, 2>> || is_pack<T> || requires {
    T::format();
};

template <InFormat T>
struct Kind<T> {
    static constexpr bool keeps_zero_signs = true;
    static constexpr int rounds = 30000;

    static FloatFormat format() {
        if constexpr (std::same_as<T, float>) return binary32;
        else if constexpr (std::same_as<T, double> || std::same_as<T, Dual<double, 2>>) return binary64;
        else if constexpr (is_pack<T>) return sizeof(T) == 4 * T::lanes ? binary32 : binary64;
        else return T::format();
    }
    static double value(T x) {
        if constexpr (std::is_floating_point_v<T>) return x;
        else if constexpr (is_pack<T>) return in_every_lane(x);
        else if constexpr (std::same_as<T, Recorded>) return x.value().value();
        else return x.value();
    }
    static bool is(T x, int v) { return value(x) == v; }
    static bool is_undefined(T x) { return std::isnan(value(x)); }

    static FloatFormat any_format(Random& random) {
        if (random.one_in(4)) return random.one_in(2) ? binary32 : binary64;
        const int p = static_cast<int>(random.between(2, 53)), wide = static_cast<int>(random.between(0, 2));
        return wide == 0   ? FloatFormat{p, -1022, 1023}
               : wide == 1 ? FloatFormat{p, -126, 127}
                           : FloatFormat{p, -14, 15};
    }

    /// A choice made anew for each round: a format, for the numbers that have one at run time only.
    struct Setting {
        explicit Setting(Random& random) {
            if constexpr (std::same_as<T, RoundedAny>)
                scope = std::make_unique<CurrentFormat::Scope>(any_format(random));
            else if constexpr (traces_operations<T>)
                recorder = std::make_unique<number::recorders::TapeRecorder>(tape, any_format(random));
        }
        Tape tape;
        std::unique_ptr<CurrentFormat::Scope> scope;
        std::unique_ptr<number::recorders::TapeRecorder> recorder;
    };
    static std::array<Operand<T>, 3> draw(Random& random, Op op) {
        const auto [a, b, c] = draw_operands(random, format(), op);
        const auto operand = [](double x) { return Operand<T>{T(x), Mpfr(x, 53)}; };
        return {operand(a), operand(b), operand(c)};
    }
    static bool keeps_promise(Op op, const T& result, const std::array<Operand<T>, 3>& x) {
        if (op == Op::copy_sign && mpfr_nan_p(x[1].point)) return true;  // no type promises the sign of a NaN
        return same_number(value(result), correctly_rounded(op, x[0].point, x[1].point, x[2].point, format()));
    }
    static std::string text(const T& x) {
        const FloatFormat f = format();
        return Mpfr(value(x), 53).text() + " in p" + std::to_string(f.precision) + " [" + std::to_string(f.emin) +
               ", " + std::to_string(f.emax) + "]";
    }
};

// --- enclosures: whatever the operands stand for, the exact result is inside --------------------------------------

/// [lower, upper] ∋ the exact result of the operation on the points.
inline bool holds_result(Op op, const std::array<const Mpfr*, 3>& x, const Mpfr& lower, const Mpfr& upper,
                         Undefined undefined) {
    constexpr long wide = 3000;  // enough for sums across the whole range of double to be exact
    Mpfr down(wide), up(wide);
    evaluate(op, down, {*x[0], *x[1], *x[2]}, MPFR_RNDD);
    evaluate(op, up, {*x[0], *x[1], *x[2]}, MPFR_RNDU);
    if (mpfr_nan_p(down) != 0) return undefined != Undefined::never;
    if (mpfr_inf_p(down) != 0) return undefined != Undefined::never || mpfr_inf_p(lower) != 0 || mpfr_inf_p(upper) != 0;
    return undefined != Undefined::always && mpfr_lessequal_p(lower, down) && mpfr_lessequal_p(up, upper);
}

template <>
struct Kind<Ball> {
    static constexpr bool keeps_zero_signs = false;
    static constexpr int rounds = 30000;
    static Mpfr end(const Ball& x, double side) {
        Mpfr r(x.hi(), 3000);
        if (!(x.radius() < HUGE_VAL)) return Mpfr(side * HUGE_VAL, 3000);
        mpfr_add_d(r, r, x.lo(), MPFR_RNDN);
        mpfr_add_d(r, r, side * x.radius(), MPFR_RNDN);
        return r;
    }
    /// Contains v, and is no wider than a hundred bits allow.
    static bool is(const Ball& x, int v) {
        return x.undefined() == Undefined::never && x.radius() <= 0x1p-95 && mpfr_cmp_si(end(x, -1), v) <= 0 &&
               mpfr_cmp_si(end(x, 1), v) >= 0;
    }
    static bool is_undefined(const Ball& x) { return x.undefined() != Undefined::never; }
    struct Setting {
        explicit Setting(Random&) {}
    };
    static Operand<Ball> one(Random& random) {
        if (random.one_in(40)) return {Ball::all_reals(), Mpfr(draw_finite(random, binary64), 53)};
        if (random.one_in(40)) return {sqrt(Ball(-1)), Mpfr(std::nan(""), 53)};
        if (random.one_in(20)) return {Ball(0), Mpfr(0, 53)};
        const int reach = random.one_in(4) ? 1000 : random.one_in(3) ? 460 : 20;
        const double hi = random.sign() * std::ldexp(draw_significand(random, 53),
                                                     static_cast<int>(random.between(-reach, std::min(reach, 960))));
        if (random.one_in(3)) return {Ball(hi), Mpfr(hi, 53)};
        const double lo =
            random.one_in(2) || std::fabs(hi) < 0x1p-800 ? 0 : hi * 0x1p-54 * (2 * random.unit() - 1) * (1 - 0x1p-50);
        const double radius =
            random.one_in(4) ? 0 : std::fabs(hi) * std::ldexp(random.unit(), static_cast<int>(random.between(-110, 2)));
        Operand<Ball> x{Ball(hi, lo, radius), Mpfr(radius, 3000)};
        mpfr_mul_si(x.point, x.point, random.between(-4, 4), MPFR_RNDN);  // the ends are most likely to be left out
        mpfr_div_ui(x.point, x.point, 4, MPFR_RNDN);
        mpfr_add_d(x.point, x.point, lo, MPFR_RNDN);
        mpfr_add_d(x.point, x.point, hi, MPFR_RNDN);
        return x;
    }
    static std::array<Operand<Ball>, 3> draw(Random& random, Op) {
        std::array<Operand<Ball>, 3> x{one(random), one(random), one(random)};
        if (random.one_in(6)) x[1] = x[0];
        if (random.one_in(6)) x[2] = x[1];
        return x;
    }
    static bool keeps_promise(Op op, const Ball& result, const std::array<Operand<Ball>, 3>& x) {
        return holds_result(op, {&x[0].point, &x[1].point, &x[2].point}, end(result, -1), end(result, 1),
                            result.undefined());
    }
    static std::string text(const Ball& x) {
        return Mpfr(x.hi(), 53).text() + " + " + Mpfr(x.lo(), 53).text() + " ± " + Mpfr(x.radius(), 53).text() +
               ", undefined " + std::to_string(static_cast<int>(x.undefined()));
    }
};

template <>
struct Kind<Interval> {
    static constexpr bool keeps_zero_signs = false;
    static constexpr int rounds = 30000;
    static bool is(const Interval& x, int v) { return x.is_exact() && mpfr_cmp_si(x.lower(), v) == 0; }
    static bool is_undefined(const Interval& x) { return x.undefined() != Undefined::never; }
    struct Setting {
        explicit Setting(Random& random) : precision(random.between(2, 300)) {}
        Interval::Precision precision;
    };
    static Operand<Interval> one(Random& random) {
        const Interval::Precision own(random.between(2, 200));
        if (random.one_in(40)) return {Interval::all_reals(), Mpfr(draw_finite(random, binary64), 53)};
        if (random.one_in(40)) return {sqrt(Interval(-1)), Mpfr(std::nan(""), 53)};
        if (random.one_in(20)) return {Interval(0), Mpfr(0, 53)};
        const double a = draw_finite(random, binary64);
        if (random.one_in(4)) return {Interval(a), Mpfr(a, 53)};
        const double b = random.one_in(4)
                             ? draw_finite(random, binary64)
                             : a * (1 + std::ldexp(random.unit(), -static_cast<int>(random.between(0, 52))));
        Operand<Interval> x{Interval::between(std::min(a, b), std::max(a, b)), Mpfr(b, 3000)};
        mpfr_sub_d(x.point, x.point, a, MPFR_RNDN);
        mpfr_mul_si(x.point, x.point, random.between(0, 4), MPFR_RNDN);
        mpfr_div_ui(x.point, x.point, 4, MPFR_RNDN);
        mpfr_add_d(x.point, x.point, a, MPFR_RNDN);
        if (!std::isfinite(b)) mpfr_set_d(x.point, a, MPFR_RNDN);
        return x;
    }
    static std::array<Operand<Interval>, 3> draw(Random& random, Op) {
        std::array<Operand<Interval>, 3> x{one(random), one(random), one(random)};
        if (random.one_in(6)) x[1] = x[0];
        if (random.one_in(6)) x[2] = x[1];
        return x;
    }
    static bool keeps_promise(Op op, const Interval& result, const std::array<Operand<Interval>, 3>& x) {
        Mpfr lower(mpfr_get_prec(result.lower())), upper(mpfr_get_prec(result.upper()));
        mpfr_set(lower, result.lower(), MPFR_RNDN);
        mpfr_set(upper, result.upper(), MPFR_RNDN);
        return holds_result(op, {&x[0].point, &x[1].point, &x[2].point}, lower, upper, result.undefined());
    }
    static std::string text(const Interval& x) {
        char buffer[320];
        mpfr_snprintf(buffer, sizeof buffer, "[%Ra, %Ra], undefined %d", x.lower(), x.upper(),
                      static_cast<int>(x.undefined()));
        return buffer;
    }
};

// --- MPFR at a fixed width: rounded once, exponents without end ---------------------------------------------------

template <>
struct Kind<Real> {
    static constexpr bool keeps_zero_signs = true;
    static constexpr int rounds = 30000;
    static bool is(const Real& x, int v) { return x == v; }
    static bool is_undefined(const Real& x) { return mpfr_nan_p(x.backend().data()) != 0; }
    struct Setting {
        explicit Setting(Random&) {}
    };
    static std::array<Operand<Real>, 3> draw(Random& random, Op op) {
        const auto d = draw_operands(random, binary64, op);
        const auto operand = [&](double x) {
            Operand<Real> r{Real(x), Mpfr(x, 53)};
            return r;
        };
        return {operand(d[0]), operand(d[1]), operand(d[2])};
    }
    static bool keeps_promise(Op op, const Real& result, const std::array<Operand<Real>, 3>& x) {
        if (op == Op::copy_sign && mpfr_nan_p(x[1].point)) return true;
        const mpfr_srcptr got = result.backend().data();
        const long bits = mpfr_get_prec(got);
        Mpfr want(bits), slack(bits);
        evaluate(op, want, {x[0].point, x[1].point, x[2].point}, MPFR_RNDN);
        if (mpfr_nan_p(want) != 0 || mpfr_nan_p(got) != 0)
            return bits >= 256 && mpfr_nan_p(want) != 0 && mpfr_nan_p(got) != 0;
        const bool fused = op == Op::fused || op == Op::fused_square;
        if (!fused || mpfr_inf_p(want) != 0)
            return bits >= 256 && mpfr_equal_p(got, want) && mpfr_signbit(got) == mpfr_signbit(want);
        // Boost's fma rounds the product too: off by at most an ulp of the larger term.
        Mpfr error(bits);
        mpfr_mul(slack, x[0].point, x[op == Op::fused ? 1 : 0].point, MPFR_RNDU);
        mpfr_abs(slack, slack, MPFR_RNDN);
        mpfr_mul_2si(slack, slack, -bits + 1, MPFR_RNDU);
        Mpfr last(bits);
        mpfr_abs(last, want, MPFR_RNDN);
        mpfr_mul_2si(last, last, -bits + 1, MPFR_RNDU);
        mpfr_add(slack, slack, last, MPFR_RNDU);
        mpfr_sub(error, got, want, MPFR_RNDA);
        return bits >= 256 && mpfr_cmpabs(error, slack) <= 0;
    }
    static std::string text(const Real& x) {
        char buffer[320];
        mpfr_snprintf(buffer, sizeof buffer, "%Ra", x.backend().data());
        return buffer;
    }
};

}  // namespace lostbits::test
