// The analytic sphere with its sums written out, so that the driver cannot choose the order of a dot product. It gives
// the same bits as sphere.unit_half_b in C++ if + - * and sqrt are correctly rounded.
// lostbits: direction=unit roots=near format=both

float sphere(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec3 f = ro - center;
    precise float c = (f.x * f.x + f.y * f.y + f.z * f.z) - radius * radius;
    precise float b = rd.x * f.x + rd.y * f.y + rd.z * f.z;
    precise float disc = b * b - c;
    precise float t = -b - sqrt(abs(disc));
    return min(t, disc) < 0.0 ? -1.0 : t;
}
