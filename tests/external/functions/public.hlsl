// The triangle of many shaders in HLSL: structures, several ends, mul for a dot product.
struct Ray {
    float3 origin;
    float3 direction;
};

bool hit_triangle(Ray ray, float3 v0, float3 v1, float3 v2, inout float t) {
    float3 e1 = v1 - v0, e2 = v2 - v0;
    float3 p = cross(ray.direction, e2);
    float det = dot(e1, p);
    if (abs(det) < 1e-8) return false;
    float inverse = rcp(det);
    float3 s = ray.origin - v0;
    float u = mul(s, p) * inverse;
    if (u < 0.0f || u > 1.0f) return false;
    float3 q = cross(s, e1);
    float v = dot(ray.direction, q) * inverse;
    if (v < 0.0f || u + v > 1.0f) return false;
    t = dot(e2, q) * inverse;
    return t > 0;
}

bool hit(float3 ro, float3 rd, float3 v0, float3 v1, float3 v2, out float t) {
    Ray ray = {ro, rd};
    t = 0;
    return hit_triangle(ray, v0, v1, v2, t);
}

// SolveRaySphereIntersectionEquation of microsoft/DirectX-Graphics-Samples, D3D12RaytracingProceduralGeometry,
// AnalyticPrimitives.hlsli at a6c390db: both roots, with the same operations in the same order, written again.
bool sphere_roots(Ray ray, out float near, out float far, float3 centre, float radius) {
    float3 f = ray.origin - centre;
    float dd = dot(ray.direction, ray.direction), fd = 2 * dot(ray.direction, f), k = dot(f, f) - radius * radius;
    near = far = 0;
    float h = fd * fd - 4 * dd * k;
    if (h < 0) return false;
    if (h == 0) {
        near = far = -0.5 * fd / dd;
    } else {
        float q = fd > 0 ? -0.5 * (fd + sqrt(h)) : -0.5 * (fd - sqrt(h));
        near = q / dd;
        far = k / q;
    }
    if (near > far) {
        float other = near;
        near = far;
        far = other;
    }
    return true;
}
