// Kahan's discriminant, written for an fma that rounds once. If the driver's fma is a product and a sum, each rounded,
// e is zero and the form equals the plain one. `precise` would not help.
// lostbits: direction=any roots=first
float kahanFma(vec3 ro, vec3 rd, vec3 center, float radius) {
    precise vec3 f = ro - center;
    precise float a = rd.x * rd.x + rd.y * rd.y + rd.z * rd.z;
    precise float h = f.x * rd.x + f.y * rd.y + f.z * rd.z;
    precise float c = (f.x * f.x + f.y * f.y + f.z * f.z) - radius * radius;
    precise float w = a * c;
    precise float e = fma(-a, c, w);
    precise float disc = fma(h, h, -w) + e;
    if (disc < 0.0) return -1.0;
    float root = sqrt(disc);
    if (h > 0.0) {
        float q = -h - root;
        return q / a < 0.0 ? c / q : q / a;
    }
    float q = -h + root;
    return c / q < 0.0 ? q / a : c / q;
}
