// Functions of public shaders: the same operations in the same order, written again.

// iquilezles.org/articles/intersectors, sphIntersect: the part of the way across, both roots.
// lostbits: direction=unit
vec2 sphere(in vec3 ro, in vec3 rd, in vec3 center, float radius) {
    vec3 v = ro - center;
    float half_b = dot(v, rd);
    vec3 across = v - half_b * rd;
    float disc = radius * radius - dot(across, across);
    if (disc < 0.0) return vec2(-1.0);
    disc = sqrt(disc);
    return vec2(-half_b - disc, -half_b + disc);
}

// The same page, capIntersect: returns in branches.
// lostbits: direction=unit
float capsule(in vec3 ro, in vec3 rd, in vec3 start, in vec3 end, in float radius) {
    vec3 axis = end - start, v = ro - start;
    float aa = dot(axis, axis), ad = dot(axis, rd), av = dot(axis, v);
    float dv = dot(rd, v), vv = dot(v, v);
    float qa = aa - ad * ad;
    float qb = aa * dv - av * ad;
    float qc = aa * vv - av * av - radius * radius * aa;
    float disc = qb * qb - qa * qc;
    if (disc >= 0.0) {
        float t = (-qb - sqrt(disc)) / qa;
        float y = av + t * ad;
        if (y > 0.0 && y < aa) return t;
        vec3 cap = (y <= 0.0) ? v : ro - end;
        qb = dot(rd, cap);
        qc = dot(cap, cap) - radius * radius;
        disc = qb * qb - qc;
        if (disc > 0.0) return -qb - sqrt(disc);
    }
    return -1.0;
}

// Slabs by 1/d, as in many shaders: two out parameters.
bool hit_box(vec3 ro, vec3 invDir, vec3 boxMin, vec3 boxMax, out float tNear, out float tFar) {
    vec3 t0 = (boxMin - ro) * invDir, t1 = (boxMax - ro) * invDir;
    vec3 lo = min(t0, t1), hi = max(t0, t1);
    tNear = max(max(lo.x, lo.y), lo.z);
    tFar = min(min(hi.x, hi.y), hi.z);
    return tNear <= tFar && tFar >= 0.0;
}

// The same page, triIntersect: t and two coordinates in a vector.
vec3 triangle(vec3 ro, vec3 rd, vec3 v0, vec3 v1, vec3 v2) {
    vec3 e1 = v1 - v0, e2 = v2 - v0, v = ro - v0;
    vec3 n = cross(e1, e2), q = cross(v, rd);
    float d = 1.0 / dot(rd, n);
    float u = d * dot(-q, e2), w = d * dot(q, e1), t = d * dot(-n, v);
    if (u < 0.0 || w < 0.0 || (u + w) > 1.0) t = -1.0;
    return vec3(t, u, w);
}
