// Bullet 3.24 in float: btCollisionWorld::rayTestSingle against a btSphereShape (btCollisionWorld.cpp:276). It casts a
// point through btSubsimplexConvexCast (btSubSimplexConvexCast.cpp:32), which iterates instead of using a formula: "GJK
// based ray cast ... objects should not start in overlap, otherwise results are not defined". A ray of Bullet is a
// segment, and the answer is a fraction of it.
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

btVector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> sphere(const Segment<float>& ray, const Sphere<float>& s) {
    btSphereShape shape(s.radius);
    btCollisionObject object;
    object.setCollisionShape(&shape);
    const btTransform none(btQuaternion::getIdentity()), at(btQuaternion::getIdentity(), vec(s.centre));
    btTransform from(none), to(none);
    from.setOrigin(vec(ray.from)), to.setOrigin(vec(ray.to));
    btCollisionWorld::ClosestRayResultCallback result(from.getOrigin(), to.getOrigin());
    btCollisionWorld::rayTestSingle(from, to, &object, &shape, at, result);
    return result.hasHit() ? Answer<float>(result.m_closestHitFraction) : miss;
}

LOSTBITS_FORMS(form<sphere>("bullet.sphere")
                   .first_root()
                   .inside_misses()
                   .origin_misses()
                   .titled("rayTestSingle of Bullet")
                   .from("Bullet 3.24, btCollisionWorld.cpp:276, btSubSimplexConvexCast.cpp:32"))
