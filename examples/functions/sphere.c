/* A function that lostbits follows as it stands: docs/your-function.md. */
#include <math.h>
#include <stdbool.h>

struct Ray {
    float origin[3];
    float direction[3];
};

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The roots of |o + t d - centre|^2 = radius^2 by the quadratic formula. */
bool hit_sphere(const struct Ray* ray, const float centre[3], float radius, float* t) {
    float v[3];
    for (int i = 0; i < 3; i++) v[i] = ray->origin[i] - centre[i];
    float a = dot(ray->direction, ray->direction);
    float b = 2.0f * dot(v, ray->direction);
    float c = dot(v, v) - radius * radius;
    float discriminant = b * b - 4.0f * a * c;
    if (discriminant < 0.0f) return false;
    float root = sqrtf(discriminant);
    float near = (-b - root) / (2.0f * a);
    float far = (-b + root) / (2.0f * a);
    *t = near >= 0.0f ? near : far;
    return *t >= 0.0f;
}
