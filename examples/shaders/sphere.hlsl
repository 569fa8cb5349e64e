// The analytic sphere of sphere.glsl in HLSL.
// lostbits: name=sphere_hlsl direction=unit roots=near touching=hit

float sphere(float3 ro, float3 rd, float3 center, float radius) {
    float3 f = ro - center;
    float b = dot(rd, f);
    float disc = b * b - (dot(f, f) - radius * radius);
    float t = -b - sqrt(abs(disc));
    return min(t, disc) < 0.0 ? -1.0 : t;
}
