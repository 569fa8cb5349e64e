// The discriminant h² - ac in numbers of two floats, hi + lo, which have about 48 bits, for drivers without doubles.
// It depends on the order of operations, which `precise` keeps; two_words.glsl is the same text without it.
// lostbits: direction=any roots=first
vec2 sum(float a, float b) {  // Knuth
    precise float s = a + b;
    precise float t = s - a;
    precise float lost = (a - (s - t)) + (b - t);
    return vec2(s, lost);
}

vec2 product(float a, float b) {  // Dekker, without fma
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

vec2 plus(vec2 a, vec2 b) {
    vec2 s = sum(a.x, b.x);
    vec2 t = sum(a.y, b.y);
    vec2 u = sum(s.x, s.y + t.x);
    return sum(u.x, u.y + t.y);
}

vec2 times(vec2 a, vec2 b) {
    vec2 p = product(a.x, b.x);
    precise float low = p.y + (a.x * b.y + a.y * b.x);
    return sum(p.x, low);
}

float twoWords(vec3 ro, vec3 rd, vec3 center, float radius) {
    vec2 a = vec2(0.0);
    vec2 h = vec2(0.0);
    vec2 c = -product(radius, radius);
    for (int i = 0; i < 3; ++i) {
        vec2 f = sum(ro[i], -center[i]);
        vec2 d = vec2(rd[i], 0.0);
        a = plus(a, times(d, d));
        h = plus(h, times(f, d));
        c = plus(c, times(f, f));
    }
    vec2 disc = plus(times(h, h), -times(a, c));
    if (disc.x < 0.0) return -1.0;
    precise float root = sqrt(disc.x);
    precise float q = h.x > 0.0 ? -h.x - root : -h.x + root;
    precise float near = h.x > 0.0 ? q / a.x : c.x / q;
    precise float far = h.x > 0.0 ? c.x / q : q / a.x;
    return near < 0.0 ? far : near;
}
