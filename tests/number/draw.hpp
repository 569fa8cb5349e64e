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
inline double draw_finite(Random& random, const FloatFormat& format) {
    const long low = format.emin - format.precision + 1, high = format.emax - format.precision + 1;
    const long middle = std::clamp<long>(1 - format.precision, low, high);
    long e = 0;
    switch (random.between(0, 5)) {
        case 0: e = random.between(low, std::min(high, low + format.precision)); break;
        case 1: e = random.between(std::max(low, high - format.precision), high); break;
        case 2: e = random.between(low, high); break;
        case 3: e = std::clamp(middle + (low - middle) / 2 + random.between(-2, 2), low, high); break;
        default: e = std::clamp(middle + random.between(-4, 4), low, high);
    }
    return random.sign() * std::ldexp(draw_significand(random, format.precision), static_cast<int>(e));
}

inline double draw_special(Random& random, const FloatFormat& format) {
    const std::array<double, 7> values{0.0,
                                       HUGE_VAL,
                                       std::nan(""),
                                       1.0,
                                       std::ldexp(2 - std::ldexp(1.0, 1 - format.precision), format.emax),
                                       std::ldexp(1.0, format.emin),
                                       std::ldexp(1.0, format.emin - format.precision + 1)};
    return random.sign() * values[random.between(0, 6)];
}

/// Operands of the format for one operation; half of them aimed at its hard cases.
inline std::array<double, 3> draw_operands(Random& random, const FloatFormat& format, Op op) {
    std::array<double, 3> x;
    for (double& v : x) v = random.one_in(40) ? draw_special(random, format) : draw_finite(random, format);
    auto& [a, b, c] = x;
    if (random.one_in(2)) return x;

    // m lies half way between two neighbours of the format: p + 1 bits, the last one set.
    Mpfr m(draw_significand(random, format.precision), 130), t(260);
    mpfr_mul_ui(m, m, 2, MPFR_RNDN);
    mpfr_add_ui(m, m, 1, MPFR_RNDN);
    mpfr_mul_2si(m, m,
                 random.one_in(3) ? format.emin - format.precision - random.between(0, 2)
                                  : random.between(-format.precision - 6, 6),
                 MPFR_RNDN);
    switch (op) {
        case Op::add:
        case Op::subtract:
            if (random.one_in(2)) {  // cancellation down to the last places
                b = nearest(Mpfr((op == Op::add ? -a : a) * (1 + static_cast<double>(random.between(-3, 3)) *
                                                                     std::ldexp(1.0, -format.precision)),
                                 53),
                            format);
            } else {  // b at or near half the last place of a
                const double tail = std::ldexp(a, -format.precision + static_cast<int>(random.between(-1, 1)));
                b = random.sign() * nearest(Mpfr(tail * (1 + static_cast<double>(random.between(-1, 1)) *
                                                                 std::ldexp(1.0, -format.precision)),
                                                 53),
                                            format);
            }
            break;
        case Op::multiply:
            if (random.one_in(2)) {  // few bits times few bits: exact midpoints are common
                const int i = static_cast<int>(random.between(1, format.precision));
                a = nearest(Mpfr(draw_significand(random, i), 53), format);
                b = nearest(Mpfr(std::ldexp(draw_significand(random, format.precision + 1 - i),
                                            static_cast<int>(random.between(-9, 0))),
                                 53),
                            format);
            } else {
                mpfr_div_d(t, m, a, MPFR_RNDN);
                b = nearest(t, format);
            }
            break;
        case Op::divide:
            mpfr_mul_d(t, m, b, MPFR_RNDN);
            a = nearest(t, format);
            break;
        case Op::root:
            mpfr_sqr(t, m, MPFR_RNDN);
            a = nearest(t, format);
            break;
        case Op::fused:
            mpfr_set_d(t, a, MPFR_RNDN);
            mpfr_mul_d(t, t, b, MPFR_RNDN);
            if (random.one_in(2)) mpfr_neg(t, t, MPFR_RNDN);
            else mpfr_sub(t, m, t, MPFR_RNDN);
            c = nearest(t, format);
            if (random.one_in(4)) c = std::nextafter(c, 0.0), c = nearest(Mpfr(c, 53), format);
            break;
        default:
            if (random.one_in(2)) b = random.sign() * a;
    }
    return x;
}

}  // namespace lostbits::test
