// Coin 4.0.0 in float, src/base/SbSphere.cpp:186, SbSphere::intersect of a line: "the intersection points of the ray".
// They may lie behind its origin. t is computed from the points, along the direction, which SbLine normalises. SbBox3f
// has no ray test.
#include <Inventor/SbLine.h>
#include <Inventor/SbSphere.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

SbVec3f vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> sphere(const Ray<float>& ray, const Sphere<float>& s) {
    const SbVec3f from = vec(ray.origin), along = vec(ray.direction);
    SbVec3f enter, exit;
    if (!SbSphere(vec(s.centre), s.radius).intersect(SbLine(from, from + along), enter, exit)) return miss;
    return {(enter - from).dot(along), (exit - from).dot(along)};
}

LOSTBITS_FORMS(form<sphere>("coin.sphere")
                   .unit_direction()
                   .whole_line()
                   .ignores_end()
                   .from("Coin 4.0.0, src/base/SbSphere.cpp:186, intersect"))
