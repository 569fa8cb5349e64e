// A box as three pairs of planes. Returns t at the entry into the last pair, and at the exit from the first.
// lostbits: miss=crossed touching=miss

vec2 slabs(vec3 ro, vec3 rd, vec3 lo, vec3 hi) {
    vec3 a = (lo - ro) / rd;
    vec3 b = (hi - ro) / rd;
    vec3 first = min(a, b);
    vec3 last = max(a, b);
    return vec2(max(max(first.x, first.y), first.z), min(min(last.x, last.y), last.z));
}
