// A function of a shader about which a user has reported wrong answers: the same operations in the same order, written
// again.

// rayTriangleHit of Oblikovati/Oblikovati, head/internal/native/shaders/sw_bvh_traverse.glsl:36 at 42b4fbae, without
// the normal. Issue 2146: a ray through the common edge of two triangles misses both.
bool triangle(vec3 origin, vec3 dir, vec3 v0, vec3 v1, vec3 v2, out float t) {
    vec3 e1 = v1 - v0;
    vec3 e2 = v2 - v0;
    vec3 pvec = cross(dir, e2);
    float det = dot(e1, pvec);
    if (abs(det) < 1e-8) return false;
    float invDet = 1.0 / det;
    vec3 tvec = origin - v0;
    float u = dot(tvec, pvec) * invDet;
    if (u < 0.0 || u > 1.0) return false;
    vec3 qvec = cross(tvec, e1);
    float v = dot(dir, qvec) * invDet;
    if (v < 0.0 || u + v > 1.0) return false;
    t = dot(e2, qvec) * invDet;
    return true;
}
