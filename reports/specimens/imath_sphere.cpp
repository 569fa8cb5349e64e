// Imath 3.1.6, ImathSphere.h:119, Sphere3::intersectT: "True if the sphere and line intersect". The comparisons are
// such that NaN passes both: finite numbers whose squares overflow give true with t = NaN.
//   g++ imath_sphere.cpp $(pkg-config --cflags --libs Imath) && ./a.out
#include <cstdio>

#include <ImathSphere.h>

int main() {
    const Imath::Sphere3f sphere(Imath::V3f(0, 0, 0), 1);
    for (const float far : {1e3F, 1e19F, 1e20F}) {
        Imath::Line3f line;
        line.pos = {-far, 2 * far, 0}, line.dir = {1, 0, 0};  // passes the unit sphere far off
        float t = 0;
        const bool hit = sphere.intersectT(line, t);
        std::printf("passing %g beside a unit sphere: expected no, got %s, t = %g\n", 2 * far, hit ? "yes" : "no", t);
    }
}
