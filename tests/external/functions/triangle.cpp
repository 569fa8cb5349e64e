// Moller and Trumbore's triangle with early returns and barycentric coordinates in references.
#include <cmath>

struct float3 {
    float x, y, z;
};
inline float3 operator-(float3 a, float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline float3 cross(float3 a, float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

bool hit_triangle(float3 orig, float3 dir, float3 v0, float3 v1, float3 v2, float& t, float& u, float& v) {
    const float3 e1 = v1 - v0, e2 = v2 - v0;
    const float3 pvec = cross(dir, e2);
    const float det = dot(e1, pvec);
    if (std::fabs(det) < 1e-8) return false;
    const float inv_det = 1 / det;
    const float3 tvec = orig - v0;
    u = dot(tvec, pvec) * inv_det;
    if (u < 0 || u > 1) return false;
    const float3 qvec = cross(tvec, e1);
    v = dot(dir, qvec) * inv_det;
    if (v < 0 || u + v > 1) return false;
    t = dot(e2, qvec) * inv_det;
    return t > 0;
}
