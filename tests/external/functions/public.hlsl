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
