// Pack: a SIMD register of numbers, so that a formula computes many rays at once. Each lane of every operation has the
// bits of the scalar operation. Only a NaN may differ, in sign and payload, which IEEE 754 leaves open and compilers
// make use of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "number/concept.hpp"

namespace lostbits {

/// The size of a register. The type is also the tag that keeps one instruction set's code apart from another's: a
/// translation unit compiled for more than the baseline derives its own tag in an anonymous namespace. Every template
/// instantiated over that tag then has internal linkage, so the linker cannot use its AVX-512 code for a function of
/// the same name that an older machine runs.
template <std::size_t Bytes>
struct Registers {
    static constexpr std::size_t bytes = Bytes;
};

/// A register of numbers, and one of integers of the same width. (The compiler's own vectors compile forms over packs
/// in two thirds of the time that std::experimental::simd takes.)
template <class F, std::size_t bytes>
struct RegisterOf {
    typedef F Numbers [[gnu::vector_size(bytes)]];
    typedef std::conditional_t<sizeof(F) == 4, std::int32_t, std::int64_t> Words [[gnu::vector_size(bytes)]];
};

#if defined(__SSE2__)
/// x86's minimum and maximum, which are `a < b ? a : b` and `a > b ? a : b` to the bit, NaN and ±0 included: the rule
/// of `min` and `max` in concept.hpp.
inline constexpr bool has_pack_registers = true;
#define LOSTBITS_PACK_REGISTER(V, prefix, suffix)                                              \
    [[gnu::always_inline]] inline V pack_min(V a, V b) { return prefix##_min_##suffix(a, b); } \
    [[gnu::always_inline]] inline V pack_max(V a, V b) { return prefix##_max_##suffix(a, b); } \
    [[gnu::always_inline]] inline V pack_sqrt(V a) { return prefix##_sqrt_##suffix(a); }
LOSTBITS_PACK_REGISTER(__m128, _mm, ps)
LOSTBITS_PACK_REGISTER(__m128d, _mm, pd)
#if defined(__AVX__)
LOSTBITS_PACK_REGISTER(__m256, _mm256, ps)
LOSTBITS_PACK_REGISTER(__m256d, _mm256, pd)
#endif
#if defined(__AVX512F__)
LOSTBITS_PACK_REGISTER(__m512, _mm512, ps)
LOSTBITS_PACK_REGISTER(__m512d, _mm512, pd)
#endif
#undef LOSTBITS_PACK_REGISTER

#if defined(__FMA__)
/// A fused multiply-add as one instruction. (With std::fma, the compiler calls a function for each lane if the
/// vectoriser of straight-line code is off, as it is for the sources of each register width. Two thirds of the
/// instructions of double-double then only split registers into lanes and joined them again.)
#define LOSTBITS_PACK_FMA(V, prefix, suffix) \
    [[gnu::always_inline]] inline V pack_fma(V a, V b, V c) { return prefix##_fmadd_##suffix(a, b, c); }
LOSTBITS_PACK_FMA(__m128, _mm, ps)
LOSTBITS_PACK_FMA(__m128d, _mm, pd)
LOSTBITS_PACK_FMA(__m256, _mm256, ps)
LOSTBITS_PACK_FMA(__m256d, _mm256, pd)
#if defined(__AVX512F__)
LOSTBITS_PACK_FMA(__m512, _mm512, ps)
LOSTBITS_PACK_FMA(__m512d, _mm512, pd)
#endif
#undef LOSTBITS_PACK_FMA
#endif

/// Converts a register of floats to two of doubles and back with one rounding, and rounds doubles to float. (GCC 12.2
/// treats the compiler's own conversion to float and back as a no-op: cmake/isa.cmake.)
[[gnu::always_inline]] inline __m128d pack_low(__m128 x) { return _mm_cvtps_pd(x); }
[[gnu::always_inline]] inline __m128d pack_high(__m128 x) { return _mm_cvtps_pd(_mm_movehl_ps(x, x)); }
[[gnu::always_inline]] inline __m128 pack_narrow(__m128d low, __m128d high) {
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
}
[[gnu::always_inline]] inline __m128d pack_round_to_float(__m128d x) { return _mm_cvtps_pd(_mm_cvtpd_ps(x)); }
#if defined(__AVX__)
[[gnu::always_inline]] inline __m256d pack_widen(__m128 x) { return _mm256_cvtps_pd(x); }
[[gnu::always_inline]] inline __m256d pack_low(__m256 x) { return _mm256_cvtps_pd(_mm256_castps256_ps128(x)); }
[[gnu::always_inline]] inline __m256d pack_high(__m256 x) { return _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1)); }
[[gnu::always_inline]] inline __m256 pack_narrow(__m256d low, __m256d high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
}
[[gnu::always_inline]] inline __m256d pack_round_to_float(__m256d x) { return _mm256_cvtps_pd(_mm256_cvtpd_ps(x)); }
#endif
#if defined(__AVX512F__)
[[gnu::always_inline]] inline __m512d pack_widen(__m256 x) { return _mm512_cvtps_pd(x); }
[[gnu::always_inline]] inline __m512d pack_low(__m512 x) { return _mm512_cvtps_pd(_mm512_castps512_ps256(x)); }
[[gnu::always_inline]] inline __m512d pack_high(__m512 x) { return _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1)); }
[[gnu::always_inline]] inline __m512 pack_narrow(__m512d low, __m512d high) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
}
[[gnu::always_inline]] inline __m512d pack_round_to_float(__m512d x) { return _mm512_cvtps_pd(_mm512_cvtpd_ps(x)); }
#endif
#else
inline constexpr bool has_pack_registers = false;
#endif

/// Decisions in a register. Each lane is all ones or all zeros.
template <class F, class Width>
struct PackDecisions {
    using Numbers = typename RegisterOf<F, Width::bytes>::Numbers;
    using Lanes = typename RegisterOf<F, Width::bytes>::Words;
    static constexpr std::size_t count = Width::bytes / sizeof(F);

    static Lanes less(Numbers a, Numbers b) { return a < b; }
    static Lanes at_most(Numbers a, Numbers b) { return a <= b; }
    static Lanes lane_and(Lanes a, Lanes b) { return a & b; }
    static Lanes lane_or(Lanes a, Lanes b) { return a | b; }
    static Lanes lane_not(Lanes a) { return ~a; }
#if defined(__AVX2__)
    static Numbers select(Lanes mask, Numbers a, Numbers b) { return mask < 0 ? a : b; }  // one instruction
#else
    static Numbers select(Lanes mask, Numbers a, Numbers b) {
        return (Numbers)(((Lanes)a & mask) | ((Lanes)b & ~mask));
    }
#endif
#if defined(__SSE2__)
    static bool any_lane(Lanes mask) {
        if constexpr (Width::bytes == 16) return _mm_movemask_epi8((__m128i)mask) != 0;
#if defined(__AVX2__)
        else return _mm256_movemask_epi8((__m256i)mask) != 0;
#endif
    }
    static void store(Lanes mask, bool* to) {
        if constexpr (sizeof(F) == 8) {
            std::uint32_t bits;
            if constexpr (Width::bytes == 16) bits = static_cast<std::uint32_t>(_mm_movemask_pd((__m128d)mask));
#if defined(__AVX2__)
            else bits = static_cast<std::uint32_t>(_mm256_movemask_pd((__m256d)mask));
#endif
            bits = bits * 0x204081 & 0x01010101;  // bit k to byte k
            std::memcpy(to, &bits, count);
        } else {
            __m128i x;
            if constexpr (Width::bytes == 16) x = _mm_packs_epi32((__m128i)mask, (__m128i)mask);
#if defined(__AVX2__)
            else x = _mm_packs_epi32(_mm256_castsi256_si128((__m256i)mask), _mm256_extracti128_si256((__m256i)mask, 1));
#endif
            x = _mm_and_si128(_mm_packs_epi16(x, x), _mm_set1_epi8(1));
            std::memcpy(to, &x, count);
        }
    }
#else
    static bool any_lane(Lanes mask) {
        bool is_any_set = false;
        for (std::size_t k = 0; k < count; ++k) is_any_set = is_any_set || mask[k] != 0;
        return is_any_set;
    }
    static void store(Lanes mask, bool* to) {
        for (std::size_t k = 0; k < count; ++k) to[k] = mask[k] != 0;
    }
#endif
    static Lanes load(const bool* from) {
        Lanes mask{};
        for (std::size_t k = 0; k < count; ++k) mask[k] = from[k] ? -1 : 0;
        return mask;
    }
};

#if defined(__AVX512DQ__)
/// Decisions in registers of 512 bits: one bit per lane. With `&` GCC computes the second of two comparisons under the
/// mask of the first; with `_kand_mask8` it emits a separate instruction.
#define LOSTBITS_PACK_DECISIONS(F, bits, suffix, words)                                                      \
    template <class Width>                                                                                   \
    requires(Width::bytes == 64) struct PackDecisions<F, Width> {                                            \
        using Numbers = typename RegisterOf<F, 64>::Numbers;                                                 \
        using Lanes = __mmask##bits;                                                                         \
        static Lanes less(Numbers a, Numbers b) { return _mm512_cmp_##suffix##_mask(a, b, _CMP_LT_OS); }     \
        static Lanes at_most(Numbers a, Numbers b) { return _mm512_cmp_##suffix##_mask(a, b, _CMP_LE_OS); }  \
        static Lanes lane_and(Lanes a, Lanes b) { return static_cast<Lanes>(a & b); }                        \
        static Lanes lane_or(Lanes a, Lanes b) { return static_cast<Lanes>(a | b); }                         \
        static Lanes lane_not(Lanes a) { return _knot_mask##bits(a); }                                       \
        static bool any_lane(Lanes mask) { return _kortestz_mask##bits##_u8(mask, mask) == 0; }              \
        static Numbers select(Lanes m, Numbers a, Numbers b) { return _mm512_mask_blend_##suffix(m, b, a); } \
        static void store(Lanes mask, bool* to) {                                                            \
            const __m128i x = _mm512_cvt##words##_epi8(_mm512_maskz_set1_##words(mask, 1));                  \
            std::memcpy(to, &x, bits);                                                                       \
        }                                                                                                    \
        static Lanes load(const bool* from) {                                                                \
            __m128i x{};                                                                                     \
            std::memcpy(&x, from, bits);                                                                     \
            const __m512i all = _mm512_cvtepu8_##words(x);                                                   \
            return _mm512_test_##words##_mask(all, all);                                                     \
        }                                                                                                    \
    };
LOSTBITS_PACK_DECISIONS(float, 16, ps, epi32)
LOSTBITS_PACK_DECISIONS(double, 8, pd, epi64)
#undef LOSTBITS_PACK_DECISIONS
#endif

/// A decision in each lane.
template <class F, class Width>
class PackMask : public NotABool {
public:
    using Decisions = PackDecisions<F, Width>;

    PackMask() = default;
    explicit PackMask(typename Decisions::Lanes lanes) : lanes_(lanes) {}

    friend PackMask operator&&(const PackMask& a, const PackMask& b) {
        return PackMask(Decisions::lane_and(a.lanes_, b.lanes_));
    }
    friend PackMask operator||(const PackMask& a, const PackMask& b) {
        return PackMask(Decisions::lane_or(a.lanes_, b.lanes_));
    }
    friend PackMask operator!(const PackMask& a) { return PackMask(Decisions::lane_not(a.lanes_)); }
    friend bool any_of(const PackMask& a) { return Decisions::any_lane(a.lanes_); }

    [[nodiscard]] typename Decisions::Lanes registers() const { return lanes_; }
    static PackMask load(const bool* from) { return PackMask(Decisions::load(from)); }
    void store(bool* to) const { Decisions::store(lanes_, to); }

private:
    mutable typename Decisions::Lanes lanes_;  // mutable for the same reason as `Pack::x_`
};

/// A register of numbers. F is float or double, Width a `Registers`, which sets the number of lanes.
template <class F, class Width>
class Pack {
public:
    using Register = typename RegisterOf<F, Width::bytes>::Numbers;
    using Words = typename RegisterOf<F, Width::bytes>::Words;
    using Lanes = PackMask<F, Width>;
    static constexpr std::size_t lanes = Width::bytes / sizeof(F);

    Pack() = default;
    explicit Pack(int x) : Pack(static_cast<F>(x)) {}
    template <std::floating_point X>
    explicit Pack(X x) : x_(static_cast<F>(x) - Register{}) {}  ///< x in every lane, rounded once where X is wider
    explicit Pack(const Register& x) : x_(x) {}
    explicit Pack(const Words& bits) : x_((Register)bits) {}

    /// Loads `lanes` numbers from any address; floats are allowed if F is double.
    template <std::floating_point X>
    static Pack load(const X* from) {
        typedef X Stored [[gnu::vector_size(lanes * sizeof(X)), gnu::aligned(alignof(X)), gnu::may_alias]];
        const auto& stored = *reinterpret_cast<const Stored*>(from);
        if constexpr (sizeof(X) == sizeof(F)) return Pack(Register(stored));
        else if constexpr (has_pack_registers && Width::bytes > 16) return Pack(Register(pack_widen(stored)));
        else return Pack(Register(__builtin_convertvector(stored, Register)));
    }
    void store(F* to) const {
        typedef F Stored [[gnu::vector_size(Width::bytes), gnu::aligned(alignof(F)), gnu::may_alias]];
        *reinterpret_cast<Stored*>(to) = x_;
    }
    [[nodiscard]] const Register& registers() const { return x_; }
    [[nodiscard]] Words words() const { return (Words)x_; }

    friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.x_ + b.x_); }
    friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.x_ - b.x_); }
    friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.x_ * b.x_); }
    friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.x_ / b.x_); }
    friend Pack operator-(const Pack& a) { return Pack(-a.x_); }
    Pack& operator+=(const Pack& b) { return *this = *this + b; }
    Pack& operator-=(const Pack& b) { return *this = *this - b; }
    Pack& operator*=(const Pack& b) { return *this = *this * b; }

    friend Lanes operator<(const Pack& a, const Pack& b) { return Lanes(Lanes::Decisions::less(a.x_, b.x_)); }
    friend Lanes operator<=(const Pack& a, const Pack& b) { return Lanes(Lanes::Decisions::at_most(a.x_, b.x_)); }
    friend Lanes operator>(const Pack& a, const Pack& b) { return b < a; }
    friend Lanes operator>=(const Pack& a, const Pack& b) { return b <= a; }

    friend Pack sqrt(const Pack& a) {
        if constexpr (has_pack_registers) return Pack(Register(pack_sqrt(a.x_)));
        else return each_lane([&a](std::size_t k) { return std::sqrt(a.x_[k]); });
    }
    friend Pack abs(const Pack& a) { return Pack(a.words() & ~sign_bit()); }
    friend Pack copysign(const Pack& a, const Pack& b) {
        return Pack((a.words() & ~sign_bit()) | (b.words() & sign_bit()));
    }
    /// Without hardware FMA, lane by lane: std::fma is correctly rounded all the same.
    friend Pack fma(const Pack& a, const Pack& b, const Pack& c) {
#if defined(__FMA__)
        return Pack(Register(pack_fma(a.x_, b.x_, c.x_)));
#else
        return each_lane([&](std::size_t k) { return std::fma(a.x_[k], b.x_[k], c.x_[k]); });
#endif
    }
    friend Pack select(const Lanes& mask, const Pack& a, const Pack& b) {
        return Pack(Register(Lanes::Decisions::select(mask.registers(), a.x_, b.x_)));
    }

    friend Pack min(const Pack& a, const Pack& b) {
        if constexpr (has_pack_registers) return Pack(Register(pack_min(a.x_, b.x_)));
        else return select(a < b, a, b);
    }
    friend Pack max(const Pack& a, const Pack& b) {
        if constexpr (has_pack_registers) return Pack(Register(pack_max(a.x_, b.x_)));
        else return select(a > b, a, b);
    }

    /// The neighbours have the neighbouring bit patterns: one more away from zero, one less towards it. +∞ has no
    /// neighbour above it, and NaN has no neighbour; both fail the test below.
    friend Pack next_up(const Pack& a) {
        const Pack x = a + Pack(0);  // −0 + 0 = +0, whose neighbour by bits is right; −0's would be −2⁻¹⁴⁹
        const Pack towards_zero(x.words() - 1), away(x.words() + 1);
        return select(a < Pack(std::numeric_limits<F>::infinity()), select(x < Pack(0), towards_zero, away), a);
    }
    friend Pack next_down(const Pack& a) { return -next_up(-a); }

    /// ±2^⌊log2|a|⌋ of normal doubles: the significand's stored bits cleared.
    friend Pack binade(const Pack& a) {
        static_assert(sizeof(F) == 8);
        return Pack(a.words() & (std::int64_t{-1} << 52));
    }

private:
    static Words sign_bit() { return Pack(F(-0.0)).words(); }
    template <class LaneFunction>
    static Pack each_lane(const LaneFunction& lane_value) {
        Register x{};
        for (std::size_t k = 0; k < lanes; ++k) x[k] = lane_value(k);
        return Pack(x);
    }

    /// Mutable only for GCC: with a const member, an inlined function writes to a local of other types through memory,
    /// and every value that the local is computed from stays in memory.
    mutable Register x_;
};

/// The doubles inside a pack of floats: number/wide/wide_pack.hpp.
template <class Width>
struct Wider<Pack<float, Width>>;

static_assert(Number<Pack<float, Registers<16>>> && Number<Pack<double, Registers<16>>>);

}  // namespace lostbits
