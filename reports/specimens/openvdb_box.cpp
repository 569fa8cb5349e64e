// OpenVDB 10.0.1, openvdb/math/Ray.h:239, Ray::intersects(bbox, t0, t1): a ray that runs in the plane of a face meets
// the box where its zero is +0 and misses it where it is -0. 0 * inf is NaN, which sorts after the other plane's -inf.
//   g++ openvdb_box.cpp -I/usr/include/Imath -lopenvdb && ./a.out
#include <cstdio>
#include <limits>
#include <utility>

#include <openvdb/math/BBox.h>
#include <openvdb/math/Ray.h>

using Ray = openvdb::math::Ray<double>;
using Vec = Ray::Vec3Type;

/// As in Ray.h, with the planes ordered by the sign of 1/d instead of by a > b.
bool mended(const Vec& eye, const Vec& inv, const openvdb::math::BBox<Vec>& box) {
    double t0 = 1e-5, t1 = std::numeric_limits<double>::max();
    for (int i = 0; i < 3; ++i) {
        double a = (box.min()[i] - eye[i]) * inv[i], b = (box.max()[i] - eye[i]) * inv[i];
        if (inv[i] < 0) std::swap(a, b);
        if (a > t0) t0 = a;
        if (b < t1) t1 = b;
        if (t0 > t1) return false;
    }
    return true;
}

int main() {
    const openvdb::math::BBox<Vec> box(Vec(-1, -1, -1), Vec(1, 1, 1));
    for (const double y : {-1.0, 1.0}) {
        for (const double zero : {0.0, -0.0}) {
            const Ray ray({-3, y, 0.5}, {1, zero, 0});
            std::printf("y = %2g, direction (1, %2g, 0): expected hit, got %s, mended %s\n", y, zero,
                        ray.intersects(box) ? "hit" : "miss", mended(ray.eye(), ray.invDir(), box) ? "hit" : "miss");
        }
    }
}
