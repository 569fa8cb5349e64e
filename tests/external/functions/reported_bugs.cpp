// Functions of C++ and CUDA libraries about which users have reported wrong answers: the same operations in the same
// order, written again, each beside its repaired form.
#include <cmath>
#include <limits>

struct Vec3 {
    float x, y, z;
    Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
    Vec3 operator-() const { return {-x, -y, -z}; }
};
inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Ray {
    Vec3 origin, direction;
};

// MOLLER_TRUMBORE_TEST of jbikker/tinybvh, tiny_bvh.h:1644 at 4735685f. Pull request 283: small triangles are missed,
// since 1e-6 is compared with a determinant that is proportional to the triangle's area.
namespace tinybvh {

bool triangle(const Ray& ray, Vec3 v0, Vec3 v1, Vec3 v2, float& t) {
    const Vec3 e1 = v1 - v0, e2 = v2 - v0;
    const Vec3 h = cross(ray.direction, e2);
    const float a = dot(e1, h);
    if (std::fabs(a) < 0.000001f) return false;
    const float f = 1 / a;
    const Vec3 s = ray.origin - v0;
    const float u = f * dot(s, h);
    const Vec3 q = cross(s, e1);
    const float v = f * dot(ray.direction, q);
    if (u < 0 || v < 0 || u + v > 1) return false;
    t = f * dot(e2, q);
    return !(t < 0);
}

// The pull request: the only determinant that is a miss is 0; a NaN in u or v is a miss, too.
bool triangle_repaired(const Ray& ray, Vec3 v0, Vec3 v1, Vec3 v2, float& t) {
    const Vec3 e1 = v1 - v0, e2 = v2 - v0;
    const Vec3 h = cross(ray.direction, e2);
    const float a = dot(e1, h);
    if (a == 0) return false;
    const float f = 1 / a;
    const Vec3 s = ray.origin - v0;
    const float u = f * dot(s, h);
    const Vec3 q = cross(s, e1);
    const float v = f * dot(ray.direction, q);
    if (!(u >= 0 && v >= 0 && u + v <= 1)) return false;
    t = f * dot(e2, q);
    return t >= 0;
}

}  // namespace tinybvh

// __intersection__sphere of mitsuba-renderer/mitsuba3, src/shapes/optix/sphere.cuh:15 at a02b57e7. Issue 512: pictures
// of a sphere have rings if the camera is 100 or 1000 radii away.
namespace mitsuba {

inline float fused_dot(const Vec3& a, const Vec3& b) { return fmaf(a.z, b.z, fmaf(a.y, b.y, a.x * b.x)); }

inline Vec3 at(const Ray& ray, float t) {
    return {fmaf(t, ray.direction.x, ray.origin.x), fmaf(t, ray.direction.y, ray.origin.y),
            fmaf(t, ray.direction.z, ray.origin.z)};
}

// include/mitsuba/render/optix/math.cuh:11 at a02b57e7; the case a = 0 is left out.
inline bool solve_quadratic(float a, float b, float c, float& x0, float& x1) {
    float discrim = fmaf(b, b, -4.f * a * c);
    if (discrim < 0.f) return false;
    float temp = -0.5f * (b + copysignf(sqrtf(discrim), b));
    float x0p = temp / a, x1p = c / temp;
    x0 = fminf(x0p, x1p);
    x1 = fmaxf(x0p, x1p);
    return true;
}

// lostbits: sphere(o, d, c, r, t)
bool sphere(const Ray& ray, Vec3 center, float radius, float& t) {
    Vec3 o = ray.origin - center;
    Vec3 d = ray.direction;
    float A = fused_dot(d, d);
    float B = 2.f * fused_dot(o, d);
    float C = fused_dot(o, o) - radius * radius;
    float near_t, far_t;
    bool solution_found = solve_quadratic(A, B, C, near_t, far_t);
    t = near_t < 0.f ? far_t : near_t;
    return solution_found && far_t >= 0.f;
}

// Commit 7d46e101: the ray starts in the plane that is perpendicular to it and contains the centre. A ray that already
// starts in this plane, beside the centre, misses.
// lostbits: sphere(o, d, c, r, t), direction = unit
bool sphere_of_2023(const Ray& ray, Vec3 center, float radius, float& t) {
    Vec3 l = ray.origin - center;
    Vec3 d = ray.direction;
    float plane_t = fused_dot(-l, d) / sqrtf(fused_dot(d, d));
    if (plane_t == 0 && (l.x != 0 || l.y != 0 || l.z != 0)) return false;
    Vec3 o = at(ray, plane_t) - center;
    if (sqrtf(fused_dot(o, o)) > radius) return false;
    float A = fused_dot(d, d);
    float B = 2.f * fused_dot(o, d);
    float C = fused_dot(o, o) - radius * radius;
    float near_t, far_t;
    bool solution_found = solve_quadratic(A, B, C, near_t, far_t);
    near_t += plane_t;
    far_t += plane_t;
    t = near_t < 0.f ? far_t : near_t;
    return solution_found && far_t >= 0.f;
}

// Commit c1af9158 repairs that too.
// lostbits: sphere(o, d, c, r, t), direction = unit
bool sphere_repaired(const Ray& ray, Vec3 center, float radius, float& t) {
    Vec3 l = ray.origin - center;
    Vec3 d = ray.direction;
    float plane_t = fused_dot(-l, d) / sqrtf(fused_dot(d, d));
    Vec3 o = at(ray, plane_t) - center;
    if (plane_t == 0.f && sqrtf(fused_dot(o, o)) > radius) return false;
    float A = fused_dot(d, d);
    float B = 2.f * fused_dot(o, d);
    float C = fused_dot(o, o) - radius * radius;
    float near_t, far_t;
    bool solution_found = solve_quadratic(A, B, C, near_t, far_t);
    near_t += plane_t;
    far_t += plane_t;
    t = near_t < 0.f ? far_t : near_t;
    return solution_found && far_t >= 0.f;
}

}  // namespace mitsuba

// Sphere::intersects of turanszkij/WickedEngine, its branch at WickedEngine/wiPrimitive.cpp:417 at c0cc9e23. Issue
// 1695: a ray that starts inside is a miss, since this branch computes the far root but does not return it.
namespace wicked {

// lostbits: sphere(o, d, tmin, tmax, c, r, t), direction = unit
bool sphere(const Ray& ray, float TMin, float TMax, Vec3 center, float radius, float& dist) {
    Vec3 OC = ray.origin - center;
    float B = dot(OC, ray.direction);
    float c = dot(OC, OC) - radius * radius;
    float discr = B * B - c;
    if (discr > 0) {
        float discrSq = std::sqrt(discr);
        float t = -B - discrSq;
        if (t < TMax && t > TMin) {
            dist = t;
            return true;
        }
        t = -B + discrSq;
        if (t < TMax && t > TMin) dist = t;
    }
    return false;
}

// lostbits: sphere(o, d, tmin, tmax, c, r, t), direction = unit
bool sphere_repaired(const Ray& ray, float TMin, float TMax, Vec3 center, float radius, float& dist) {
    Vec3 OC = ray.origin - center;
    float B = dot(OC, ray.direction);
    float c = dot(OC, OC) - radius * radius;
    float discr = B * B - c;
    if (discr > 0) {
        float discrSq = std::sqrt(discr);
        float t = -B - discrSq;
        if (t < TMax && t > TMin) {
            dist = t;
            return true;
        }
        t = -B + discrSq;
        if (t < TMax && t > TMin) {
            dist = t;
            return true;
        }
    }
    return false;
}

}  // namespace wicked

// intersectRayPlane of g-truc/glm, glm/gtx/intersect.inl:7 at ff0b1674. Issue 578: a ray parallel to the plane hits.
namespace glm {

// lostbits: plane(o, d, p, n, t), facing = front
bool plane(Vec3 orig, Vec3 dir, Vec3 planeOrig, Vec3 planeNormal, float& intersectionDistance) {
    float d = dot(dir, planeNormal);
    float Epsilon = std::numeric_limits<float>::epsilon();
    if (d < Epsilon) {
        intersectionDistance = dot(planeOrig - orig, planeNormal) / d;
        return true;
    }
    return false;
}

// Commit e7d51a38: parallel rays miss, and so do rays that would hit behind their origin.
// lostbits: plane(o, d, p, n, t)
bool plane_repaired(Vec3 orig, Vec3 dir, Vec3 planeOrig, Vec3 planeNormal, float& intersectionDistance) {
    float d = dot(dir, planeNormal);
    float Epsilon = std::numeric_limits<float>::epsilon();
    if (std::fabs(d) > Epsilon) {
        float tmp = dot(planeOrig - orig, planeNormal) / d;
        if (tmp > 0) {
            intersectionDistance = tmp;
            return true;
        }
    }
    return false;
}

}  // namespace glm
