/* What cannot be followed: each is refused with its line and column. */
#include <math.h>

float sine(const float* o, const float* d, const float* c, float r) { return sinf(o[0]) + d[0] + c[0] + r; }

float endless(const float* o, const float* d, const float* c, float r) {
    float t = 0;
    while (t < 100) t += fabsf(o[0] + t * d[0] - c[0]) - r;
    return t;
}

float rounded(const float* o, const float* d, const float* c, float r) { return (float)(int)(o[0] - c[0]) + d[0] + r; }

static float calls;
float counting(const float* o, const float* d, const float* c, float r) {
    calls += 1;
    return o[0] + d[0] - c[0] - r + calls;
}
