// box.signs and box.inclusive by hand, 512-bit registers.
#include <immintrin.h>

#include "by_hand.hpp"

namespace by_hand {
namespace {

using V = __m512;
constexpr std::size_t lanes = sizeof(V) / sizeof(float);
constexpr auto set1 = [](float x) { return _mm512_set1_ps(x); };
constexpr auto load = [](const float* p) { return _mm512_loadu_ps(p); };
constexpr auto sub = [](V a, V b) { return _mm512_sub_ps(a, b); };
constexpr auto mul = [](V a, V b) { return _mm512_mul_ps(a, b); };
constexpr auto min = [](V a, V b) { return _mm512_min_ps(a, b); };
constexpr auto max = [](V a, V b) { return _mm512_max_ps(a, b); };

void keep(float* t, V tmin, V tmax, V old) {
    _mm512_storeu_ps(t, _mm512_mask_blend_ps(_mm512_cmp_ps_mask(tmin, tmax, _CMP_LE_OQ), old, tmin));
}

struct OneRay {
    V o[3], inv[3];
    explicit OneRay(const float* ray) {
        for (int k = 0; k < 3; ++k) o[k] = set1(ray[k]), inv[k] = set1(1 / ray[3 + k]);
    }
};

}  // namespace

void signs_w512(const float* ray, const float* const columns[6], float* t, std::size_t n) {
    const OneRay r(ray);
    const float *first[3], *second[3];
    for (int k = 0; k < 3; ++k) {
        const bool sign = __builtin_signbit(1 / ray[3 + k]);
        first[k] = columns[sign ? k + 3 : k];
        second[k] = columns[sign ? k : k + 3];
    }
    for (std::size_t i = 0; i < n; i += lanes) {
        const V old = load(t + i);
        V tmin = set1(0), tmax = old;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            tmin = max(mul(sub(load(first[k] + i), r.o[k]), r.inv[k]), tmin);
            tmax = min(mul(sub(load(second[k] + i), r.o[k]), r.inv[k]), tmax);
        }
        keep(t + i, tmin, tmax, old);
    }
}

void inclusive_w512(const float* ray, const float* const columns[6], float* t, std::size_t n) {
    const OneRay r(ray);
    const float* const c[6] = {columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
    for (std::size_t i = 0; i < n; i += lanes) {
        const V old = load(t + i);
        V tmin = set1(0), tmax = old;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            const V t1 = mul(sub(load(c[k] + i), r.o[k]), r.inv[k]), t2 = mul(sub(load(c[k + 3] + i), r.o[k]), r.inv[k]);
            tmin = min(max(t1, tmin), max(t2, tmin));
            tmax = max(min(t1, tmax), min(t2, tmax));
        }
        keep(t + i, tmin, tmax, old);
    }
}

}  // namespace by_hand
