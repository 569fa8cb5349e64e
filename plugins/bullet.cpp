// Bullet 3.24 in float. btCollisionWorld::rayTestSingle against a btSphereShape (btCollisionWorld.cpp:276, which casts a
// point through btSubsimplexConvexCast: iterations, not a formula; no answer from inside), btRayAabb
// (LinearMath/btAabbUtil2.h:117) and btRayAabb2 (:82). Bullet's rays are segments: a ray without an end gets one behind
// the solid. 1/d of btRayAabb2 is made as btCollisionWorld::rayTest makes it (btCollisionWorld.cpp:815).
#include <algorithm>
#include <cmath>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <LinearMath/btAabbUtil2.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

btVector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> sphere(const Ray<float>& ray, const Sphere<float>& s) {
    btSphereShape shape(s.radius);
    btCollisionObject object;
    object.setCollisionShape(&shape);
    const btTransform none(btQuaternion::getIdentity()), at(btQuaternion::getIdentity(), vec(s.centre));
    const float length = std::min(ray.end, (vec(s.centre) - vec(ray.origin)).length() + 2 * s.radius);
    btTransform from(none), to(none);
    from.setOrigin(vec(ray.origin)), to.setOrigin(vec(ray.origin) + length * vec(ray.direction));
    btCollisionWorld::ClosestRayResultCallback result(from.getOrigin(), to.getOrigin());
    btCollisionWorld::rayTestSingle(from, to, &object, &shape, at, result);
    return result.hasHit() ? Answer<float>(result.m_closestHitFraction * length) : miss;
}
Answer<float> aabb(const Ray<float>& ray, const Box<float>& b) {
    const btVector3 from = vec(ray.origin), middle = 0.5F * (vec(b.lo) + vec(b.hi));
    const float length = std::min(ray.end, (middle - from).length() + (vec(b.hi) - vec(b.lo)).length());
    btVector3 normal;
    float part = 1;
    if (!btRayAabb(from, from + length * vec(ray.direction), vec(b.lo), vec(b.hi), part, normal)) return miss;
    return {part * length};
}
Answer<float> aabb2(const Ray<float>& ray, const Box<float>& b) {
    btVector3 over;
    unsigned sign[3];
    for (int k = 0; k < 3; ++k) {
        over[k] = ray.direction[k] == 0 ? btScalar(BT_LARGE_FLOAT) : 1 / ray.direction[k];
        sign[k] = over[k] < 0;
    }
    const btVector3 bounds[2] = {vec(b.lo), vec(b.hi)};
    float t = 0;
    if (!btRayAabb2(vec(ray.origin), over, sign, bounds, t, 0, ray.end)) return miss;
    return {std::max(t, 0.0F)};
}

constexpr Form of(Form form, const char* title, const char* where) {
    return form.unit_direction().titled(title).from(where);
}

LOSTBITS_FORMS(of(form<sphere>("bullet.sphere"), "rayTestSingle of Bullet against a sphere shape",
                  "Bullet 3.24, btCollisionWorld.cpp:276, btSubSimplexConvexCast.cpp:32").near_root(),
               of(form<aabb>("bullet.aabb"), "btRayAabb of Bullet", "Bullet 3.24, LinearMath/btAabbUtil2.h:117").first_root(),
               of(form<aabb2>("bullet.aabb2"), "btRayAabb2 of Bullet", "Bullet 3.24, LinearMath/btAabbUtil2.h:82").first_root())
