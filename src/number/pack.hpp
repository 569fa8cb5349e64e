// Pack: what does it cost in bulk? A SIMD register of numbers, so that a formula computes many rays at once. Every
// operation gives in each lane the bits that the scalar operation gives; a NaN may differ in sign and payload, which
// IEEE 754 leaves open and compilers use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <limits>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "number/concept.hpp"

namespace lostbits {

/// The size of a register, and the tag that keeps one instruction set's code apart from another's: a translation unit
/// compiled for more than the baseline derives its own tag in an anonymous namespace. Everything instantiated over it
/// then has internal linkage, and the linker cannot hand AVX-512 code to a function of the same name that an older
/// machine runs.
template <std::size_t Bytes>
struct Registers {
    static constexpr std::size_t bytes = Bytes;
};

namespace stdx = std::experimental;

template <class F, class Width>
using PackAbi = stdx::simd_abi::deduce_t<F, Width::bytes / sizeof(F)>;

#if defined(__SSE2__)
/// x86's minimum and maximum, which are `a < b ? a : b` and `a > b ? a : b` to the bit, NaN and ±0 included: the rule
/// of `min` and `max` in concept.hpp.
inline constexpr bool has_pack_registers = true;
#define LOSTBITS_PACK_MINMAX(V, prefix, suffix)                                                \
    [[gnu::always_inline]] inline V pack_min(V a, V b) { return prefix##_min_##suffix(a, b); } \
    [[gnu::always_inline]] inline V pack_max(V a, V b) { return prefix##_max_##suffix(a, b); }
LOSTBITS_PACK_MINMAX(__m128, _mm, ps)
LOSTBITS_PACK_MINMAX(__m128d, _mm, pd)
#if defined(__AVX__)
LOSTBITS_PACK_MINMAX(__m256, _mm256, ps)
LOSTBITS_PACK_MINMAX(__m256d, _mm256, pd)
#endif
#if defined(__AVX512F__)
LOSTBITS_PACK_MINMAX(__m512, _mm512, ps)
LOSTBITS_PACK_MINMAX(__m512d, _mm512, pd)
#endif
#undef LOSTBITS_PACK_MINMAX

#if defined(__FMA__)
/// One instruction. (std::fma of each lane stays one of each lane where the vectoriser of straight code is off, as in
/// the objects of the widths: two thirds of the instructions of double-double took lanes apart and joined them.)
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

/// A register of floats as two of doubles, and back with one rounding. (stdx goes through memory, where a whole
/// register waits until both of its halves have been stored: the second step of sphere.filtered took twice as long.)
[[gnu::always_inline]] inline __m128d pack_low(__m128 x) { return _mm_cvtps_pd(x); }
[[gnu::always_inline]] inline __m128d pack_high(__m128 x) { return _mm_cvtps_pd(_mm_movehl_ps(x, x)); }
[[gnu::always_inline]] inline __m128 pack_narrow(__m128d low, __m128d high) {
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
}
#if defined(__AVX__)
[[gnu::always_inline]] inline __m256d pack_low(__m256 x) { return _mm256_cvtps_pd(_mm256_castps256_ps128(x)); }
[[gnu::always_inline]] inline __m256d pack_high(__m256 x) { return _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1)); }
[[gnu::always_inline]] inline __m256 pack_narrow(__m256d low, __m256d high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
}
#endif
#if defined(__AVX512F__)
[[gnu::always_inline]] inline __m512d pack_low(__m512 x) { return _mm512_cvtps_pd(_mm512_castps512_ps256(x)); }
[[gnu::always_inline]] inline __m512d pack_high(__m512 x) { return _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1)); }
[[gnu::always_inline]] inline __m512 pack_narrow(__m512d low, __m512d high) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
}
#endif
#else
inline constexpr bool has_pack_registers = false;
#endif

/// A decision in each lane.
template <class F, class Width>
class PackMask : public NotABool {
public:
    using Simd = stdx::simd_mask<F, PackAbi<F, Width>>;

    PackMask() = default;
    explicit PackMask(const Simd& lanes) : lanes_(lanes) {}

    friend PackMask operator&&(const PackMask& a, const PackMask& b) {
        if constexpr (sizeof(Simd) == sizeof(Bits)) return from_bits(a.bits() & b.bits());
        else return PackMask(a.lanes_ && b.lanes_);
    }
    friend PackMask operator||(const PackMask& a, const PackMask& b) {
        if constexpr (sizeof(Simd) == sizeof(Bits)) return from_bits(a.bits() | b.bits());
        else return PackMask(a.lanes_ || b.lanes_);
    }
    friend PackMask operator!(const PackMask& a) { return PackMask(!a.lanes_); }
    friend bool any_of(const PackMask& a) { return stdx::any_of(a.lanes_); }

    [[nodiscard]] const Simd& simd() const { return lanes_; }
    void store(bool* to) const { lanes_.copy_to(to, stdx::element_aligned); }

private:
    /// Of masks with a bit a lane, as AVX-512 has them: by `&` of these GCC makes the second of two comparisons one
    /// under the mask of the first, and by that of stdx an instruction of its own.
    using Bits = std::conditional_t<Width::bytes == 8 * sizeof(F), std::uint8_t, std::uint16_t>;
    [[nodiscard]] Bits bits() const { return __builtin_bit_cast(Bits, lanes_); }
    static PackMask from_bits(int bits) { return PackMask(__builtin_bit_cast(Simd, static_cast<Bits>(bits))); }

    mutable Simd lanes_;  // as `Pack::x_`
};

/// F is float or double, Width a `Registers`; as many lanes as fit.
template <class F, class Width>
class Pack {
public:
    using Simd = stdx::simd<F, PackAbi<F, Width>>;
    using Lanes = PackMask<F, Width>;
    static constexpr std::size_t lanes = Simd::size();
    static_assert(lanes * sizeof(F) == Width::bytes);

    Pack() = default;
    explicit Pack(int x) : x_(static_cast<F>(x)) {}
    template <std::floating_point X>
    explicit Pack(X x) : x_(static_cast<F>(x)) {}  ///< x in every lane, rounded once where X is wider
    explicit Pack(const Simd& x) : x_(x) {}

    /// `lanes` numbers from any address.
    static Pack load(const F* from) { return Pack(Simd(from, stdx::element_aligned)); }
    void store(F* to) const { x_.copy_to(to, stdx::element_aligned); }
    [[nodiscard]] const Simd& simd() const { return x_; }

    friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.x_ + b.x_); }
    friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.x_ - b.x_); }
    friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.x_ * b.x_); }
    friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.x_ / b.x_); }
    friend Pack operator-(const Pack& a) { return Pack(-a.x_); }
    Pack& operator+=(const Pack& b) { return *this = *this + b; }
    Pack& operator-=(const Pack& b) { return *this = *this - b; }
    Pack& operator*=(const Pack& b) { return *this = *this * b; }

    friend Lanes operator<(const Pack& a, const Pack& b) { return Lanes(a.x_ < b.x_); }
    friend Lanes operator<=(const Pack& a, const Pack& b) { return Lanes(a.x_ <= b.x_); }
    friend Lanes operator>(const Pack& a, const Pack& b) { return Lanes(a.x_ > b.x_); }
    friend Lanes operator>=(const Pack& a, const Pack& b) { return Lanes(a.x_ >= b.x_); }

    friend Pack sqrt(const Pack& a) { return Pack(stdx::sqrt(a.x_)); }
    friend Pack abs(const Pack& a) { return Pack(stdx::abs(a.x_)); }
    friend Pack copysign(const Pack& a, const Pack& b) { return Pack(stdx::copysign(a.x_, b.x_)); }
    /// Without FMA lane by lane: std::fma is correctly rounded all the same.
    friend Pack fma(const Pack& a, const Pack& b, const Pack& c) {
#if defined(__FMA__)
        return Pack(__builtin_bit_cast(Simd, pack_fma(a.registers(), b.registers(), c.registers())));
#else
        const auto lane = [](const Simd& x, auto i) { return static_cast<F>(x[i]); };
        return Pack(Simd([&](auto i) { return std::fma(lane(a.x_, i), lane(b.x_, i), lane(c.x_, i)); }));
#endif
    }
    friend Pack select(const Lanes& mask, const Pack& a, const Pack& b) {
        Simd chosen = b.x_;
        stdx::where(mask.simd(), chosen) = a.x_;
        return Pack(chosen);
    }

    friend Pack min(const Pack& a, const Pack& b) {
        if constexpr (has_pack_registers) return Pack(__builtin_bit_cast(Simd, pack_min(a.registers(), b.registers())));
        else return select(a < b, a, b);
    }
    friend Pack max(const Pack& a, const Pack& b) {
        if constexpr (has_pack_registers) return Pack(__builtin_bit_cast(Simd, pack_max(a.registers(), b.registers())));
        else return select(a > b, a, b);
    }

    /// The neighbours are the neighbours of the bits: one more away from zero, one less towards it. +∞ has none above
    /// it, NaN none at all; both fail the test below.
    friend Pack next_up(const Pack& a) {
        const Pack x = a + Pack(0);  // −0 + 0 = +0, whose neighbour by bits is right; −0's would be −2⁻¹⁴⁹
        const Bits bits = __builtin_bit_cast(Bits, x.x_);
        const Pack towards_zero(__builtin_bit_cast(Simd, bits - 1)), away(__builtin_bit_cast(Simd, bits + 1));
        return select(a < Pack(std::numeric_limits<F>::infinity()), select(x < Pack(0), towards_zero, away), a);
    }
    friend Pack next_down(const Pack& a) { return -next_up(-a); }

    /// ±2^⌊log2|a|⌋ of normal doubles: the significand's stored bits cleared.
    friend Pack binade(const Pack& a) {
        static_assert(sizeof(F) == 8);
        return Pack(__builtin_bit_cast(Simd, __builtin_bit_cast(Bits, a.x_) & (std::int64_t{-1} << 52)));
    }

    typedef F Register [[gnu::vector_size(Width::bytes)]];
    [[nodiscard]] Register registers() const { return __builtin_bit_cast(Register, x_); }

private:
    using Bits = stdx::rebind_simd_t<std::conditional_t<sizeof(F) == 4, std::int32_t, std::int64_t>, Simd>;

    /// Mutable for GCC alone: to a const local of other types a function that is inlined writes through memory, and all
    /// that it is made of stays there.
    mutable Simd x_;
};

/// The doubles inside a pack of floats: as many lanes, twice the registers.
template <class Width>
class WidePack {
public:
    using Half = Pack<double, Width>;
    using Narrow = Pack<float, Width>;

    /// A decision in each lane; it is a decision about the floats, too.
    struct Lanes {
        PackMask<double, Width> low, high;

        friend Lanes operator&&(const Lanes& a, const Lanes& b) { return {a.low && b.low, a.high && b.high}; }
        friend Lanes operator||(const Lanes& a, const Lanes& b) { return {a.low || b.low, a.high || b.high}; }
        friend Lanes operator!(const Lanes& a) { return {!a.low, !a.high}; }
        friend bool any_of(const Lanes& a) { return any_of(a.low) || any_of(a.high); }
        operator PackMask<float, Width>() const { return select(*this, WidePack(1), WidePack(0)).narrow() > Narrow(0); }
    };

    WidePack() = default;
    explicit WidePack(int x) : low_(x), high_(x) {}
    explicit WidePack(double x) : low_(x), high_(x) {}
    WidePack(const Half& low, const Half& high) : low_(low), high_(high) {}
    explicit WidePack(const Narrow& x) {
        if constexpr (has_pack_registers) {
            low_ = Half(__builtin_bit_cast(typename Half::Simd, pack_low(x.registers())));
            high_ = Half(__builtin_bit_cast(typename Half::Simd, pack_high(x.registers())));
        } else {
            float lanes[Narrow::lanes];
            x.store(lanes);
            low_ = Half(typename Half::Simd(lanes, stdx::element_aligned));
            high_ = Half(typename Half::Simd(lanes + Half::lanes, stdx::element_aligned));
        }
    }
    /// Each lane rounded once.
    [[nodiscard]] Narrow narrow() const {
        if constexpr (has_pack_registers)
            return Narrow(__builtin_bit_cast(typename Narrow::Simd, pack_narrow(low_.registers(), high_.registers())));
        else
            return Narrow(stdx::concat(stdx::static_simd_cast<HalfOfFloats>(low_.simd()),
                                       stdx::static_simd_cast<HalfOfFloats>(high_.simd())));
    }

    friend WidePack operator+(const WidePack& a, const WidePack& b) { return {a.low_ + b.low_, a.high_ + b.high_}; }
    friend WidePack operator-(const WidePack& a, const WidePack& b) { return {a.low_ - b.low_, a.high_ - b.high_}; }
    friend WidePack operator*(const WidePack& a, const WidePack& b) { return {a.low_ * b.low_, a.high_ * b.high_}; }
    friend WidePack operator/(const WidePack& a, const WidePack& b) { return {a.low_ / b.low_, a.high_ / b.high_}; }
    friend WidePack operator-(const WidePack& a) { return {-a.low_, -a.high_}; }
    WidePack& operator+=(const WidePack& b) { return *this = *this + b; }
    WidePack& operator-=(const WidePack& b) { return *this = *this - b; }
    WidePack& operator*=(const WidePack& b) { return *this = *this * b; }

    friend Lanes operator<(const WidePack& a, const WidePack& b) { return {a.low_ < b.low_, a.high_ < b.high_}; }
    friend Lanes operator<=(const WidePack& a, const WidePack& b) { return {a.low_ <= b.low_, a.high_ <= b.high_}; }
    friend Lanes operator>(const WidePack& a, const WidePack& b) { return {a.low_ > b.low_, a.high_ > b.high_}; }
    friend Lanes operator>=(const WidePack& a, const WidePack& b) { return {a.low_ >= b.low_, a.high_ >= b.high_}; }

    friend WidePack sqrt(const WidePack& a) { return {sqrt(a.low_), sqrt(a.high_)}; }
    friend WidePack abs(const WidePack& a) { return {abs(a.low_), abs(a.high_)}; }
    friend WidePack copysign(const WidePack& a, const WidePack& b) {
        return {copysign(a.low_, b.low_), copysign(a.high_, b.high_)};
    }
    friend WidePack fma(const WidePack& a, const WidePack& b, const WidePack& c) {
        return {fma(a.low_, b.low_, c.low_), fma(a.high_, b.high_, c.high_)};
    }
    friend WidePack select(const Lanes& mask, const WidePack& a, const WidePack& b) {
        return {select(mask.low, a.low_, b.low_), select(mask.high, a.high_, b.high_)};
    }
    friend WidePack next_up(const WidePack& a) { return {next_up(a.low_), next_up(a.high_)}; }
    friend WidePack next_down(const WidePack& a) { return {next_down(a.low_), next_down(a.high_)}; }

private:
    using HalfOfFloats = stdx::simd<float, PackAbi<float, Registers<Width::bytes / 2>>>;

    Half low_, high_;
};

template <class Width>
struct Wider<Pack<float, Width>> {
    using type = WidePack<Width>;
    static type widen(const Pack<float, Width>& x) { return type(x); }
    static Pack<float, Width> narrow(const type& x) { return x.narrow(); }
};

static_assert(Number<Pack<float, Registers<16>>> && Number<Pack<double, Registers<16>>> &&
              Number<WidePack<Registers<16>>>);

}  // namespace lostbits
