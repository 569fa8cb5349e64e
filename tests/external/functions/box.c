/* Slabs in a loop over the axes, with swapped planes and early returns. */
#include <math.h>

struct ray {
    float o[3], d[3];
};
struct aabb {
    float bounds[2][3];
};

int hit_box(const struct ray* r, const struct aabb* b, float* tnear) {
    float t0 = 0, t1 = INFINITY;
    for (int k = 0; k < 3; k++) {
        float inv = 1 / r->d[k];
        float lo = (b->bounds[0][k] - r->o[k]) * inv, hi = (b->bounds[1][k] - r->o[k]) * inv;
        if (inv < 0) {
            float swapped = lo;
            lo = hi;
            hi = swapped;
        }
        if (lo > t0) t0 = lo;
        if (hi < t1) t1 = hi;
        if (t0 > t1) return 0;
    }
    *tnear = t0;
    return 1;
}

double slabs(const double* org, const double* inv_dir, const double* bmin, const double* bmax) {
    double t0 = 0, t1 = 1e300;
    for (int k = 0; k < 3; k++) {
        const double a = (bmin[k] - org[k]) * inv_dir[k], b = (bmax[k] - org[k]) * inv_dir[k];
        t0 = fmax(t0, fmin(a, b));
        t1 = fmin(t1, fmax(a, b));
    }
    return t0 <= t1 ? t0 : -1;
}
