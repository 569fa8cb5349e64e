// The analytic sphere with its sums written out, so that the driver has no dot product to order: the same bits as
// sphere.unit_half_b in C++ wherever + - * and sqrt are correctly rounded.
// lostbits: direction=unit roots=near format=both

float sphere(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec3 rc = ro - center;
    precise float c = (rc.x * rc.x + rc.y * rc.y + rc.z * rc.z) - radius * radius;
    precise float b = rd.x * rc.x + rd.y * rc.y + rd.z * rc.z;
    precise float d = b * b - c;
    precise float t = -b - sqrt(abs(d));
    float st = step(0.0, min(t, d));
    return mix(-1.0, t, st);
}
