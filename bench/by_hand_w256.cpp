// Loops with intrinsics of 256-bit registers.
#include <immintrin.h>

#include "by_hand_loops.hpp"

namespace by_hand {
namespace {

struct Singles {
    using F = float;
    using V = __m256;
    using M = __m256;
    static constexpr std::size_t lanes = 8;
    static V set1(F x) { return _mm256_set1_ps(x); }
    static V load(const F* p) { return _mm256_loadu_ps(p); }
    static void store(F* p, V x) { _mm256_storeu_ps(p, x); }
    static V add(V a, V b) { return _mm256_add_ps(a, b); }
    static V sub(V a, V b) { return _mm256_sub_ps(a, b); }
    static V mul(V a, V b) { return _mm256_mul_ps(a, b); }
    static V div(V a, V b) { return _mm256_div_ps(a, b); }
    static V min(V a, V b) { return _mm256_min_ps(a, b); }
    static V max(V a, V b) { return _mm256_max_ps(a, b); }
    static V sqrt(V a) { return _mm256_sqrt_ps(a); }
    static V negate(V a) { return _mm256_xor_ps(a, _mm256_set1_ps(-0.0F)); }
    static V abs(V a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), a); }
    static V flip(V a, V sign) { return _mm256_xor_ps(a, _mm256_and_ps(sign, _mm256_set1_ps(-0.0F))); }
    static M less(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
    static M less_equal(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
    static M both(M a, M b) { return _mm256_and_ps(a, b); }
    static M either(M a, M b) { return _mm256_or_ps(a, b); }
    static M invert(M a) { return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1))); }
    static V choose(M m, V a, V b) { return _mm256_blendv_ps(b, a, m); }
    static void store_neither(unsigned char* p, M a, M b) {
        const __m256i either = _mm256_castps_si256(_mm256_or_ps(a, b));
        const __m128i words = _mm_packs_epi32(_mm256_castsi256_si128(either), _mm256_extracti128_si256(either, 1));
        _mm_storel_epi64(reinterpret_cast<__m128i*>(p), _mm_add_epi8(_mm_packs_epi16(words, words), _mm_set1_epi8(1)));
    }
};

struct Doubles {
    using F = double;
    using V = __m256d;
    using M = __m256d;
    static constexpr std::size_t lanes = 4;
    static V set1(F x) { return _mm256_set1_pd(x); }
    static V load(const F* p) { return _mm256_loadu_pd(p); }
    static void store(F* p, V x) { _mm256_storeu_pd(p, x); }
    static V add(V a, V b) { return _mm256_add_pd(a, b); }
    static V sub(V a, V b) { return _mm256_sub_pd(a, b); }
    static V mul(V a, V b) { return _mm256_mul_pd(a, b); }
    static V div(V a, V b) { return _mm256_div_pd(a, b); }
    static V min(V a, V b) { return _mm256_min_pd(a, b); }
    static V max(V a, V b) { return _mm256_max_pd(a, b); }
    static V sqrt(V a) { return _mm256_sqrt_pd(a); }
    static V negate(V a) { return _mm256_xor_pd(a, _mm256_set1_pd(-0.0)); }
    static V abs(V a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
    static V flip(V a, V sign) { return _mm256_xor_pd(a, _mm256_and_pd(sign, _mm256_set1_pd(-0.0))); }
    static M less(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
    static M less_equal(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
    static M both(M a, M b) { return _mm256_and_pd(a, b); }
    static M either(M a, M b) { return _mm256_or_pd(a, b); }
    static M invert(M a) { return _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi32(-1))); }
    static V choose(M m, V a, V b) { return _mm256_blendv_pd(b, a, m); }
    static void store_neither(unsigned char* p, M a, M b) {
        const __m256i either = _mm256_castpd_si256(_mm256_or_pd(a, b));
        const __m128i longs =
            _mm_packs_epi32(_mm256_castsi256_si128(either), _mm256_extracti128_si256(either, 1));  // each lane twice
        const __m128i words = _mm_packs_epi32(longs, longs), bytes = _mm_packs_epi16(words, words);
        _mm_storeu_si32(p, _mm_add_epi8(bytes, _mm_set1_epi8(1)));
    }
};

}  // namespace

Width width_256() { return {loops<Singles>(), loops<Doubles>()}; }

}  // namespace by_hand
