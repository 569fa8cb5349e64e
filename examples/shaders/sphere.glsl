// The analytic sphere of shader libraries: t² + 2bt + c = 0 with a = 1, the nearest root, -1 for a miss.
// lostbits: direction=unit roots=near touching=hit
// lostbits: title="t^2 + 2bt + c = 0 with a = 1, nearest root"

float sphere(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec3 rc = ro - center;
    float c = dot(rc, rc) - radius * radius;
    float b = dot(rd, rc);
    float d = b * b - c;
    float t = -b - sqrt(abs(d));
    float st = step(0.0, min(t, d));
    return mix(-1.0, t, st);
}
