// The analytic sphere of shader libraries: t² + 2bt + c = 0 with a = 1. Returns the near root, or -1 for a miss.
// lostbits: direction=unit roots=near touching=hit
// lostbits: title="t^2 + 2bt + c = 0 with a = 1, nearest root"

float sphere(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec3 f = ro - center;
    float b = dot(rd, f);
    float disc = b * b - (dot(f, f) - radius * radius);
    float t = -b - sqrt(abs(disc));
    return min(t, disc) < 0.0 ? -1.0 : t;
}
