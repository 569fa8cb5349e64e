/* Functions of public C libraries: the same operations in the same order, written again. */
#include <math.h>
#include <stdbool.h>

static void sub3(const float a[3], const float b[3], float to[3]) {
    for (int i = 0; i < 3; i++) to[i] = a[i] - b[i];
}
static float dot3(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void cross3(const float a[3], const float b[3], float to[3]) {
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

/* glm_ray_triangle of cglm, include/cglm/ray.h:42 at 1337e9cd: arrays, early returns. */
bool ray_triangle(float origin[3], float direction[3], float v0[3], float v1[3], float v2[3], float* d) {
    const float epsilon = 0.000001f;
    float edge1[3], edge2[3], p[3], t[3], q[3];
    sub3(v1, v0, edge1);
    sub3(v2, v0, edge2);
    cross3(direction, edge2, p);
    float det = dot3(edge1, p);
    if (det > -epsilon && det < epsilon) return false;
    float inv_det = 1.0f / det;
    sub3(origin, v0, t);
    float u = inv_det * dot3(t, p);
    if (u < 0.0f || u > 1.0f) return false;
    cross3(t, edge1, q);
    float v = inv_det * dot3(direction, q);
    if (v < 0.0f || u + v > 1.0f) return false;
    float dist = inv_det * dot3(edge2, q);
    if (d) *d = dist;
    return dist > epsilon;
}

/* HitBoundingBox of Graphics Gems, gems/RayBox.c:14 at 3f85c80f: loops, arrays indexed by a decision, no t. */
/* lostbits: box(lo, hi, o, d, -) */
char HitBoundingBox(double minB[3], double maxB[3], double origin[3], double dir[3], double coord[3]) {
    enum { right, left, middle };
    char inside = 1, quadrant[3];
    int plane = 0;
    double maxT[3], candidate[3];
    for (int i = 0; i < 3; i++) {
        if (origin[i] < minB[i]) {
            quadrant[i] = left, candidate[i] = minB[i], inside = 0;
        } else if (origin[i] > maxB[i]) {
            quadrant[i] = right, candidate[i] = maxB[i], inside = 0;
        } else {
            quadrant[i] = middle;
        }
    }
    if (inside) return 1;
    for (int i = 0; i < 3; i++) {
        if (quadrant[i] != middle && dir[i] != 0.) maxT[i] = (candidate[i] - origin[i]) / dir[i];
        else maxT[i] = -1.;
    }
    for (int i = 1; i < 3; i++)
        if (maxT[plane] < maxT[i]) plane = i;
    if (maxT[plane] < 0.) return 0;
    for (int i = 0; i < 3; i++) {
        if (plane != i) {
            coord[i] = origin[i] + maxT[plane] * dir[i];
            if (coord[i] < minB[i] || coord[i] > maxB[i]) return 0;
        } else {
            coord[i] = candidate[i];
        }
    }
    return 1;
}
