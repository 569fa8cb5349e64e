// Bullet 3.24 in float, btConvexCast.h:30: the ray test of every convex shape ends where the squared distance is below
// MAX_CONVEX_CAST_EPSILON = 0.0001, that is 0.01 units from the shape, whatever its size.
//   g++ bullet_sphere.cpp $(pkg-config --cflags --libs bullet) && ./a.out
#include <cmath>
#include <cstdio>

#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletCollisionCommon.h>

float shipped(const btTransform& from, const btTransform& to, btSphereShape& sphere) {
    btCollisionObject object;
    object.setCollisionShape(&sphere);
    btCollisionWorld::ClosestRayResultCallback result(from.getOrigin(), to.getOrigin());
    btCollisionWorld::rayTestSingle(from, to, &object, &sphere, btTransform::getIdentity(), result);
    return result.hasHit() ? result.m_closestHitFraction : NAN;
}
/// The same cast with a threshold that goes with the shape: (1e-4 of its radius)^2.
float mended(const btTransform& from, const btTransform& to, btSphereShape& sphere) {
    btSphereShape point(0);
    btVoronoiSimplexSolver solver;
    solver.setEqualVertexThreshold(1e-8F * sphere.getRadius() * sphere.getRadius());
    btConvexCast::CastResult cast;
    cast.m_fraction = 1;
    cast.m_subSimplexCastEpsilon = 1e-8F * sphere.getRadius() * sphere.getRadius();
    const btTransform none = btTransform::getIdentity();
    btSubsimplexConvexCast caster(&point, &sphere, &solver);
    return caster.calcTimeOfImpact(from, to, none, none, cast) ? cast.m_fraction : NAN;
}

void show(float radius, float beside) {
    btSphereShape sphere(radius);
    btTransform from = btTransform::getIdentity(), to = from;
    from.setOrigin({-1, beside, 0}), to.setOrigin({1, beside, 0});
    const auto x = [](float fraction) { return 2 * fraction - 1; };
    const double square = double(radius) * radius - double(beside) * beside;
    std::printf("radius %g, %g from the centre: expected x = %.6g, got %.6g, mended %.6g (nan: no hit)\n", radius,
                beside, square < 0 ? NAN : -std::sqrt(square), x(shipped(from, to, sphere)),
                x(mended(from, to, sphere)));
}

int main() {
    show(0.5F, 0.505F);    // beside it
    show(0.5F, 0.495F);    // near its silhouette
    show(0.001F, 0.009F);  // nine radii from the centre
    show(0.0001F, 0.0099F);
    show(0.01F, 0.005F);
}
