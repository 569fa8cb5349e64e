// kahan_split_precise.glsl without `precise`. A driver may then compute one of the sums in another order and lose the
// small parts of the products.
// lostbits: direction=any roots=first
vec2 product(float a, float b) {
    float p = a * b;
    float ka = 4097.0 * a;
    float kb = 4097.0 * b;
    float ah = ka - (ka - a);
    float bh = kb - (kb - b);
    float al = a - ah;
    float bl = b - bh;
    float lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return vec2(p, lost);
}

float kahanSplit(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec3 f = ro - center;
    float a = rd.x * rd.x + rd.y * rd.y + rd.z * rd.z;
    float h = f.x * rd.x + f.y * rd.y + f.z * rd.z;
    float c = (f.x * f.x + f.y * f.y + f.z * f.z) - radius * radius;
    vec2 hh = product(h, h);
    vec2 ac = product(a, c);
    float disc = ((hh.x - ac.x) + hh.y) - ac.y;
    if (disc < 0.0) return -1.0;
    float root = sqrt(disc);
    float q = h > 0.0 ? -h - root : -h + root;
    float near = h > 0.0 ? q / a : c / q;
    float far = h > 0.0 ? c / q : q / a;
    return near < 0.0 ? far : near;
}
