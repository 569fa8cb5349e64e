// Loops with intrinsics of 512-bit registers.
#include <immintrin.h>

#include "by_hand_loops.hpp"

namespace by_hand {
namespace {

struct Singles {
    using F = float;
    using V = __m512;
    using M = __mmask16;
    static constexpr std::size_t lanes = 16;
    static V set1(F x) { return _mm512_set1_ps(x); }
    static V load(const F* p) { return _mm512_loadu_ps(p); }
    static void store(F* p, V x) { _mm512_storeu_ps(p, x); }
    static V add(V a, V b) { return _mm512_add_ps(a, b); }
    static V sub(V a, V b) { return _mm512_sub_ps(a, b); }
    static V mul(V a, V b) { return _mm512_mul_ps(a, b); }
    static V div(V a, V b) { return _mm512_div_ps(a, b); }
    static V min(V a, V b) { return _mm512_min_ps(a, b); }
    static V max(V a, V b) { return _mm512_max_ps(a, b); }
    static V sqrt(V a) { return _mm512_sqrt_ps(a); }
    static V negate(V a) { return _mm512_xor_ps(a, _mm512_set1_ps(-0.0F)); }
    static V abs(V a) { return _mm512_abs_ps(a); }
    static V flip(V a, V sign) { return _mm512_xor_ps(a, _mm512_and_ps(sign, _mm512_set1_ps(-0.0F))); }
    static M less(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
    static M less_equal(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
    static M both(M a, M b) { return static_cast<M>(a & b); }
    static M either(M a, M b) { return static_cast<M>(a | b); }
    static M invert(M a) { return static_cast<M>(~a); }
    static V choose(M m, V a, V b) { return _mm512_mask_blend_ps(m, b, a); }
    static void store_neither(unsigned char* p, M a, M b) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(p),
                         _mm512_cvtepi32_epi8(_mm512_maskz_set1_epi32(static_cast<M>(~(a | b)), 1)));
    }
};

struct Doubles {
    using F = double;
    using V = __m512d;
    using M = __mmask8;
    static constexpr std::size_t lanes = 8;
    static V set1(F x) { return _mm512_set1_pd(x); }
    static V load(const F* p) { return _mm512_loadu_pd(p); }
    static void store(F* p, V x) { _mm512_storeu_pd(p, x); }
    static V add(V a, V b) { return _mm512_add_pd(a, b); }
    static V sub(V a, V b) { return _mm512_sub_pd(a, b); }
    static V mul(V a, V b) { return _mm512_mul_pd(a, b); }
    static V div(V a, V b) { return _mm512_div_pd(a, b); }
    static V min(V a, V b) { return _mm512_min_pd(a, b); }
    static V max(V a, V b) { return _mm512_max_pd(a, b); }
    static V sqrt(V a) { return _mm512_sqrt_pd(a); }
    static V negate(V a) { return _mm512_xor_pd(a, _mm512_set1_pd(-0.0)); }
    static V abs(V a) { return _mm512_abs_pd(a); }
    static V flip(V a, V sign) { return _mm512_xor_pd(a, _mm512_and_pd(sign, _mm512_set1_pd(-0.0))); }
    static M less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
    static M less_equal(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
    static M both(M a, M b) { return static_cast<M>(a & b); }
    static M either(M a, M b) { return static_cast<M>(a | b); }
    static M invert(M a) { return static_cast<M>(~a); }
    static V choose(M m, V a, V b) { return _mm512_mask_blend_pd(m, b, a); }
    static void store_neither(unsigned char* p, M a, M b) {
        _mm_storel_epi64(reinterpret_cast<__m128i*>(p),
                         _mm512_cvtepi64_epi8(_mm512_maskz_set1_epi64(static_cast<M>(~(a | b)), 1)));
    }
};

}  // namespace

Width width_512() { return {loops<Singles>(), loops<Doubles>()}; }

}  // namespace by_hand
