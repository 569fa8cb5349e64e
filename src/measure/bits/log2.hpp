// log2 with the same bits on every machine: additions, products and one quotient, no fma, no libm.
#pragma once

#include <bit>
#include <cstdint>

namespace lostbits::measure::bits {

/// x = m·2^k with √½ ≤ m < √2 (to within 2^-20).
template <class T>
struct NearOne {
    T k, m;
};

/// Bits of √½, cut to the first 32: significands from here up to √2 belong to the same k.
inline constexpr std::uint64_t bits_of_root_half = 0x3fe6'a09e'0000'0000, bits_of_one = 0x3ff0'0000'0000'0000,
                               bits_of_fraction = 0x000f'ffff'ffff'ffff, bits_of_two_52 = 0x4330'0000'0000'0000;

/// Operations of log2 on the bits of a double. (kernels.hpp of measure/columns has the same for the lanes of a pack.)
struct ScalarBits {
    /// Splits a normal x > 0.
    static NearOne<double> near_one(double x) {
        const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) + (bits_of_one - bits_of_root_half);
        // 2^52 + e as a double has e as its last bits.
        return {std::bit_cast<double>((shifted >> 52) | bits_of_two_52) - (0x1p52 + 1023),
                std::bit_cast<double>((shifted & bits_of_fraction) + bits_of_root_half)};
    }
    /// x with the last 27 bits of its significand zero: 26 bits are left.
    static double leading_half(double x) {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~((std::uint64_t{1} << 27) - 1));
    }
};

/// log2 x for a normal number x > 0, with an error below 1.4 ulp of the result; exactly k for 2^k.
///
/// With f = m − 1 (exact) and s = f/(2 + f): ln m = 2 artanh s = f − g, g = f²/2 − s(f²/2 + R), R = s²·P(s²), where
/// P is the polynomial of degree 6 through 2/3 + 2z/5 + 2z²/7 + … at the Chebyshev points of [0, 0.02944]; its
/// truncation error is less than 2^-57 of ln m. 1/ln 2 = c1 + c2, c1 of 26 bits: the product with the leading half of f
/// is exact, and so is the rounding error of the sum with k (k = 0, or |k| ≥ 1 > |log2 m|). Roundings weigh most near m
/// = √½, where the result is just below ½: there g/ln 2 < 0.078, so its product and the two sums around it cost an
/// eighth of an ulp each, the roundings inside g (f²/2, s, the product, the difference) a third together, the
/// polynomial and the constant c an eighth, and the last sum a half.
template <class Bits, class T>
T log2_by(const T& number) {
    const NearOne<T> x = Bits::near_one(number);
    const T f = x.m - T(1);
    const T s = f / (T(2) + f);
    const T z = s * s, w = z * z;
    const T even = w * (T(0x1.99999999952e2p-2) + w * (T(0x1.c71c62e5800a1p-3) + w * T(0x1.39fe606542ddep-3)));
    const T odd = z * (T(0x1.5555555555558p-1) +
                       w * (T(0x1.2492492df148dp-2) + w * (T(0x1.7462b4ab2ef6bp-3) + w * T(0x1.2b584aae78a57p-3))));
    const T half_square = T(0.5) * f * f;
    const T g = half_square - s * (half_square + (even + odd));
    const T c1(0x1.7154768p+0), c2(-0x1.6a3e80f444178p-27), c(0x1.71547652b82fep+0);
    const T leading = Bits::leading_half(f);
    const T product = leading * c1;
    const T rest = (f - leading) * c1 + (f * c2 - g * c);
    const T sum = x.k + product;
    return sum + (((x.k - sum) + product) + rest);
}

inline double log2_of(double x) { return log2_by<ScalarBits>(x); }

}  // namespace lostbits::measure::bits
