// Sphere tracing: each step is as long as the distance to the surface, until that is below a threshold.
// lostbits: direction=unit roots=near inside=zero
#define HIT_EPS 0.001
#define MAX_STEPS 64
#define MAX_DIST 20.0

float map(vec3 p, vec4 sphere) { return length(p - sphere.xyz) - sphere.w; }

float march(vec3 ro, vec3 rd, vec4 sphere) {
    float t = 0.0;
    for (int i = 0; i < MAX_STEPS; ++i) {
        float d = map(ro + rd * t, sphere);
        if (d < HIT_EPS) return t;
        t += d;
        if (t > MAX_DIST) break;
    }
    return -1.0;
}
