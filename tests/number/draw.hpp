// Hard operands: sparse and dense significands, the ends of the exponent range, cancellation, and results on or beside
// the midpoint of two neighbours.
#pragma once

#include <algorithm>
#include <array>

#include "number/oracle.hpp"
#include "number/random.hpp"

namespace lostbits::test {

/// A positive integer of at most `bits` bits.
inline double draw_significand(Random& random, int bits) {
    const std::uint64_t all = (std::uint64_t{1} << bits) - 1;
    const auto bit = [&] { return std::uint64_t{1} << random.between(0, bits - 1); };
    std::uint64_t k = random.bits() & all;
    switch (random.between(0, 4)) {
        case 0: k = bit() | bit(); break;
        case 1: k = all & ~(bit() | bit()); break;
        case 2: k = bit() | bit() | bit() | 1; break;
        case 3: k &= all >> random.between(0, bits - 1); break;
        default: k |= std::uint64_t{1} << (bits - 1);
    }
    return static_cast<double>(std::max<std::uint64_t>(k, 1));
}

/// A finite number of the format other than zero: k·2^e with k < 2^p and 2^e no smaller than the smallest subnormal.
inline double draw_finite(Random& random, const FloatFormat& f) {
    const long low = f.emin - f.precision + 1, high = f.emax - f.precision + 1;
    const long middle = std::clamp<long>(1 - f.precision, low, high);
    long e = 0;
    switch (random.between(0, 5)) {
        case 0: e = random.between(low, std::min(high, low + f.precision)); break;
        case 1: e = random.between(std::max(low, high - f.precision), high); break;
        case 2: e = random.between(low, high); break;
        case 3: e = std::clamp(middle + (low - middle) / 2 + random.between(-2, 2), low, high); break;
        default: e = std::clamp(middle + random.between(-4, 4), low, high);
    }
    return random.sign() * std::ldexp(draw_significand(random, f.precision), static_cast<int>(e));
}

inline double draw_special(Random& random, const FloatFormat& f) {
    const std::array<double, 7> values{0.0,
                                       HUGE_VAL,
                                       std::nan(""),
                                       1.0,
                                       std::ldexp(2 - std::ldexp(1.0, 1 - f.precision), f.emax),
                                       std::ldexp(1.0, f.emin),
                                       std::ldexp(1.0, f.emin - f.precision + 1)};
    return random.sign() * values[random.between(0, 6)];
}

/// Operands of the format for one operation; half of them aimed at its hard cases.
inline std::array<double, 3> draw_operands(Random& random, const FloatFormat& f, Op op) {
    std::array<double, 3> x;
    for (double& v : x) v = random.one_in(40) ? draw_special(random, f) : draw_finite(random, f);
    auto& [a, b, c] = x;
    if (random.one_in(2)) return x;

    // m lies half way between two neighbours of the format: p + 1 bits, the last one set.
    Mpfr m(draw_significand(random, f.precision), 130), t(260);
    mpfr_mul_ui(m, m, 2, MPFR_RNDN);
    mpfr_add_ui(m, m, 1, MPFR_RNDN);
    mpfr_mul_2si(m, m,
                 random.one_in(3) ? f.emin - f.precision - random.between(0, 2) : random.between(-f.precision - 6, 6),
                 MPFR_RNDN);
    switch (op) {
        case Op::add:
        case Op::subtract:
            if (random.one_in(2)) {  // cancellation down to the last places
                b = nearest(Mpfr((op == Op::add ? -a : a) *
                                     (1 + static_cast<double>(random.between(-3, 3)) * std::ldexp(1.0, -f.precision)),
                                 53),
                            f);
            } else {  // b at or near half the last place of a
                const double tail = std::ldexp(a, -f.precision + static_cast<int>(random.between(-1, 1)));
                b = random.sign() *
                    nearest(
                        Mpfr(tail * (1 + static_cast<double>(random.between(-1, 1)) * std::ldexp(1.0, -f.precision)),
                             53),
                        f);
            }
            break;
        case Op::multiply:
            if (random.one_in(2)) {  // few bits times few bits: exact midpoints are common
                const int i = static_cast<int>(random.between(1, f.precision));
                a = nearest(Mpfr(draw_significand(random, i), 53), f);
                b = nearest(Mpfr(std::ldexp(draw_significand(random, f.precision + 1 - i),
                                            static_cast<int>(random.between(-9, 0))),
                                 53),
                            f);
            } else {
                mpfr_div_d(t, m, a, MPFR_RNDN);
                b = nearest(t, f);
            }
            break;
        case Op::divide:
            mpfr_mul_d(t, m, b, MPFR_RNDN);
            a = nearest(t, f);
            break;
        case Op::root:
            mpfr_sqr(t, m, MPFR_RNDN);
            a = nearest(t, f);
            break;
        case Op::fused:
            mpfr_set_d(t, a, MPFR_RNDN);
            mpfr_mul_d(t, t, b, MPFR_RNDN);
            if (random.one_in(2)) mpfr_neg(t, t, MPFR_RNDN);
            else mpfr_sub(t, m, t, MPFR_RNDN);
            c = nearest(t, f);
            if (random.one_in(4)) c = std::nextafter(c, 0.0), c = nearest(Mpfr(c, 53), f);
            break;
        default:
            if (random.one_in(2)) b = random.sign() * a;
    }
    return x;
}

}  // namespace lostbits::test
