// filtered_precise.glsl without `precise`. No operation here subtracts a number that was just added, so drivers find
// nothing to rewrite. The bound would also cover another order of the sums.
// lostbits: direction=any roots=first
float inDoubles(dvec3 f, dvec3 d, double r) {
    double a = d.x * d.x + d.y * d.y + d.z * d.z;
    double h = f.x * d.x + f.y * d.y + f.z * d.z;
    double c = (f.x * f.x + f.y * f.y + f.z * f.z) - r * r;
    float disc = float(h * h - a * c);
    float root = sqrt(disc);
    float q = abs(float(h)) + root;
    if (c == 0.0) return 0.0;
    bool within = float(c) <= 0.0 && float(h) <= 0.0;
    if (float(c) > 0.0 && (float(h) > 0.0 || disc < 0.0)) return -1.0;
    return within ? q / float(a) : abs(float(c)) / q;
}

float filtered(vec3 ro, vec3 rd, vec3 center, float radius) {
    const float u = 5.9604645e-8;
    vec3 f = center - ro;
    float ff = f.x * f.x + f.y * f.y + f.z * f.z;
    float r2 = radius * radius;
    float inv = 1.0 / (rd.x * rd.x + rd.y * rd.y + rd.z * rd.z);
    float s = (f.x * rd.x + f.y * rd.y + f.z * rd.z) * inv;
    vec3 l = f - s * rd;
    float delta = r2 - (l.x * l.x + l.y * l.y + l.z * l.z);
    float root = sqrt(delta * inv);
    float w = (2.1 * u) * (abs(f.x) + abs(f.y) + abs(f.z)) + 4.0 * u * radius;
    float e = w * (2.0 * radius + 32.0 * w);
    bool open = s > 0.0 && delta >= -e;
    bool met = s > 0.0 && delta > 4.0 * e && e * inv <= root * (36.0 * u * s - 66.0 * u * root);
    if (ff >= 2.0 * r2 && !open) return -1.0;
    float t = s - root;
    if (ff >= 2.0 * r2 && met) return t;
    return inDoubles(dvec3(ro) - dvec3(center), dvec3(rd), double(radius));
}
