// OpenVDB 10.0.1, openvdb/math/Ray.h:193, Ray::intersects(center, radius, t0, t1): the stable quadratic is written with
// its sign the wrong way round, so the sum that was to avoid cancellation is the one that cancels, for every ray.
//   g++ openvdb_sphere.cpp -I/usr/include/Imath -lopenvdb && ./a.out
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include <openvdb/math/Ray.h>

using Ray = openvdb::math::Ray<float>;
using Vec = Ray::Vec3Type;

/// As in Ray.h, with the two signs of the line of Q exchanged.
bool mended(const Vec& eye, const Vec& dir, const Vec& center, float radius, float& t0, float& t1) {
    const Vec origin = eye - center;
    const float A = dir.lengthSqr(), B = 2 * dir.dot(origin), C = origin.lengthSqr() - radius * radius;
    const float D = B * B - 4 * A * C;
    if (D < 0) return false;
    const float Q = -0.5F * (B < 0 ? (B - std::sqrt(D)) : (B + std::sqrt(D)));
    t0 = Q / A, t1 = C / Q;
    if (t0 > t1) std::swap(t0, t1);
    return true;
}

void show(const char* what, const Vec& eye, const Vec& dir, float radius, const char* expected) {
    const Vec center(0, 0, 0);
    constexpr float most = std::numeric_limits<float>::max();
    float t0 = 0, t1 = 0, m0 = 0, m1 = 0;
    const bool hit = Ray(eye, dir, -most, most).intersects(center, radius, t0, t1);  // the whole line
    const bool mended_hit = mended(eye, dir, center, radius, m0, m1);
    std::printf("%s\n  expected %s\n  got      %s", what, expected, hit ? "" : "no intersection\n");
    if (hit) std::printf("%.9g %.9g\n", t0, t1);
    std::printf("  mended   %s%.9g %.9g\n", mended_hit ? "" : "no intersection ", m0, m1);
}

int main() {
    show("from the surface through the centre", {1, 0, 0}, {-1, 0, 0}, 1, "0 2");
    show("from the surface outwards", {1, 0, 0}, {1, 0, 0}, 1, "-2 0");
    show("a hundredth below the surface, through the sphere", {0.99F, 0, 0}, {-1, 0, 0}, 1, "-0.0099999905 1.99000001");
    show("an eighth above a sphere of radius 1e6, looking down; t1", {0, 1000000.125F, 0}, {0, -1, 0}, 1e6F,
         "0.125 2000000.12");
    // A ray as it comes, which begins at t = 1e-5: the same.
    std::printf("as the constructor makes a ray, from the surface through the centre: expected hit, got %s\n",
                Ray({1, 0, 0}, {-1, 0, 0}).intersects(Vec(0, 0, 0), 1) ? "hit" : "miss");
}
