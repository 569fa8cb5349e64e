// The analytic sphere for rays that have a range, such as shadow rays and bounces. Returns the first root with
// tmin <= t <= tmax.
// lostbits: direction=unit roots=first flags=range format=both

float sphere(vec3 ro, vec3 rd, vec3 center, float radius, float tmin, float tmax) {
    vec3 f = ro - center;
    float b = dot(rd, f);
    float disc = b * b - (dot(f, f) - radius * radius);
    if (disc < 0.0) return -1.0;
    float h = sqrt(disc);
    float t = -b - h < tmin ? h - b : -b - h;
    return t < tmin || t > tmax ? -1.0 : t;
}
