// Kahan's discriminant h² - ac without fma. Both products keep their rounding errors (Dekker's split of a factor into
// halves of 12 bits), so the result is correct to two units in the last place.
// This needs `precise`; kahan_split.glsl is the same text without it.
// lostbits: direction=any roots=first
vec2 product(float a, float b) {
    precise float p = a * b;
    precise float ka = 4097.0 * a;
    precise float kb = 4097.0 * b;
    precise float ah = ka - (ka - a);
    precise float bh = kb - (kb - b);
    precise float al = a - ah;
    precise float bl = b - bh;
    precise float lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return vec2(p, lost);
}

float kahanSplit(vec3 ro, vec3 rd, vec3 center, float radius) {
    precise vec3 f = ro - center;
    precise float a = rd.x * rd.x + rd.y * rd.y + rd.z * rd.z;
    precise float h = f.x * rd.x + f.y * rd.y + f.z * rd.z;
    precise float c = (f.x * f.x + f.y * f.y + f.z * f.z) - radius * radius;
    vec2 hh = product(h, h);
    vec2 ac = product(a, c);
    precise float disc = ((hh.x - ac.x) + hh.y) - ac.y;
    if (disc < 0.0) return -1.0;
    precise float root = sqrt(disc);
    precise float q = h > 0.0 ? -h - root : -h + root;
    precise float near = h > 0.0 ? q / a : c / q;
    precise float far = h > 0.0 ? c / q : q / a;
    return near < 0.0 ? far : near;
}
