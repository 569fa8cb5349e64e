/* A sphere with early returns and t in an out parameter. */
#include <math.h>
#include <stdbool.h>

typedef struct {
    float x, y, z;
} vec3;

static vec3 sub(vec3 a, vec3 b) {
    vec3 r = {a.x - b.x, a.y - b.y, a.z - b.z};
    return r;
}

static float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

bool hit_sphere(vec3 o, vec3 d, vec3 c, float r, float* t) {
    vec3 f = sub(o, c);
    float a = dot(d, d);
    float b = dot(f, d);
    float cc = dot(f, f) - r * r;
    float disc = b * b - a * cc;
    if (disc < 0) return false;
    float s = sqrtf(disc);
    *t = (-b - s) / a;
    if (*t < 0) *t = (-b + s) / a;
    return *t >= 0;
}

/* The same operations as sphere.schoolbook of the catalogue, and -1 for a miss. */
float schoolbook(const float o[3], const float d[3], const float centre[3], float radius) {
    float v[3] = {o[0] - centre[0], o[1] - centre[1], o[2] - centre[2]};
    float a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    float b = 2 * (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]);
    float c = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - radius * radius;
    float disc = b * b - 4 * a * c;
    if (disc < 0) return -1;
    float root = sqrt(disc);
    float t0 = (-b - root) / (2 * a), t1 = (-b + root) / (2 * a);
    float t = t0 < 0 ? t1 : t0;
    return t < 0 ? -1 : t;
}

double precise(const double* o, const double* d, const double* centre, double radius) {
    double v[3], a = 0, b = 0, c = -radius * radius;
    for (int k = 0; k < 3; ++k) {
        v[k] = o[k] - centre[k];
        a += d[k] * d[k];
        b += v[k] * d[k];
        c += v[k] * v[k];
    }
    const double disc = b * b - a * c;
    if (disc < 0) return INFINITY;
    const double t = (-b - sqrt(disc)) / a;
    return t < 0 ? INFINITY : t;
}

/* Computes in double inside, as C does without the f of sqrtf. */
float mixed_sphere(vec3 o, vec3 d, vec3 c, float r) {
    vec3 f = sub(o, c);
    double b = dot(f, d);
    double disc = b * b - dot(d, d) * (dot(f, f) - 1.0 * r * r);
    if (disc < 1e-9) return NAN;
    return (-b - sqrt(disc)) / dot(d, d);
}
