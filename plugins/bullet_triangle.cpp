// Bullet 3.24 in float, btTriangleRaycastCallback::processTriangle (btRaycastCallback.cpp:35). It takes the distances
// of both ends of a segment from the plane, then tests the edges with "an epsilon as a tolerance", a ten-thousandth of
// the squared normal. The segment ends behind the triangle, at twice the distance of its farthest vertex, or at the end
// of the ray if that is nearer.
#include <algorithm>

#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

btVector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

struct Closest final : btTriangleRaycastCallback {
    using btTriangleRaycastCallback::btTriangleRaycastCallback;
    btScalar reportHit(const btVector3&, btScalar part, int, int) override { return part; }
};

Answer<float> triangle(const Ray<float>& ray, const Triangle<float>& s) {
    btVector3 vertices[3] = {vec(s.a), vec(s.b), vec(s.c)};
    const btVector3 from = vec(ray.origin);
    float length = 0;
    for (const btVector3& v : vertices) length = std::max(length, 2 * (v - from).length());
    length = std::min(length, ray.end);
    Closest caster(from, from + length * vec(ray.direction));
    caster.processTriangle(vertices, 0, 0);
    return caster.m_hitFraction < 1 ? Answer<float>(caster.m_hitFraction * length) : miss;
}

LOSTBITS_FORMS(form<triangle>("bullet.triangle")
                   .unit_direction()
                   .first_root()
                   .origin_misses()
                   .from("Bullet 3.24, btRaycastCallback.cpp:35, processTriangle"))
