/* A small path tracer with spheres, diffuse bounces and two threads. It writes every test of a ray with a sphere to
 * rays.npy.
 *
 *     cc -O2 -Iplugins examples/dump/tracer.c -o tracer -lm -lpthread
 *     ./tracer rays.npy && lostbits judge rays.npy --rows -o out */
#include <lostbits_dump.h>
#include <math.h>
#include <pthread.h>

enum { width = 48, height = 32, depth = 3 };

static const float spheres[][4] = {{0, 0, -1000, 999}, {0, 0, 0, 1}, {2.2f, 0.4f, 0, 1}, {-2, -1, 0.2f, 0.9f}};
static lostbits_dump dump;

/* The intersector under test: the quadratic formula, as many renderers have it. */
static float meet(const float* o, const float* d, const float* s, unsigned id) {
    const float f[3] = {o[0] - s[0], o[1] - s[1], o[2] - s[2]};
    const float a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], b = 2 * (f[0] * d[0] + f[1] * d[1] + f[2] * d[2]);
    const float c = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] - s[3] * s[3], disc = b * b - 4 * a * c;
    const float root = sqrtf(disc), near = (-b - root) / (2 * a), far = (-b + root) / (2 * a), tmin = 1e-3f;
    const float t = near >= tmin ? near : far;
    const int hit = disc >= 0 && t >= tmin;
    lostbits_dump_add(&dump, id, o, d, tmin, INFINITY, s, hit, t);
    return hit ? t : -1;
}

static float random_number(unsigned* state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.0f * 2 - 1;
}

static void trace(int x, int y) {
    unsigned state = (unsigned)(y * width + x) * 2654435761u;
    float o[3] = {0, -9, 1}, d[3] = {((float)x + 0.5f) / width - 0.5f, 1, 0.3f - ((float)y + 0.5f) / height * 0.6f};
    for (unsigned bounce = 0; bounce < depth; ++bounce) {
        float first = -1;
        const float* met = NULL;
        for (size_t k = 0; k < sizeof spheres / sizeof spheres[0]; ++k) {
            const float t = meet(o, d, spheres[k], bounce);
            if (t >= 0 && (first < 0 || t < first)) first = t, met = spheres[k];
        }
        if (met == NULL) return;
        for (int k = 0; k < 3; ++k) o[k] += first * d[k];
        for (int k = 0; k < 3; ++k) d[k] = (o[k] - met[k]) / met[3] + 0.9f * random_number(&state);
    }
}

static void* trace_lines(void* from) {
    for (int y = *(int*)from; y < height; y += 2)
        for (int x = 0; x < width; ++x) trace(x, y);
    return NULL;
}

int main(int count, char** words) {
    int first[2] = {0, 1};
    pthread_t threads[2];
    const unsigned long long room = (unsigned long long)width * height * depth * 4;
    if (count != 2 || lostbits_dump_begin(&dump, room, "sphere") != 0) return 2;
    for (int i = 0; i < 2; ++i)
        if (pthread_create(&threads[i], NULL, trace_lines, &first[i]) != 0) return 3;
    for (int i = 0; i < 2; ++i) pthread_join(threads[i], NULL);
    printf("%llu rays\n", dump.count);
    return lostbits_dump_end(&dump, words[1]) == 0 ? 0 : 3;
}
