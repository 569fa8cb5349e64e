// Bullet 3.24 in float, LinearMath/btAabbUtil2.h:117, btRayAabb, and :82, btRayAabb2. Neither documents a promise.
// btRayAabb takes a segment and returns a fraction of it. btRayAabb2 takes 1/d, which is computed here as in
// btCollisionWorld.cpp:815, with 1e18 for 1/0.
#include <algorithm>

#include <LinearMath/btAabbUtil2.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

btVector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> aabb(const Segment<float>& ray, const Box<float>& b) {
    btVector3 normal;
    float part = 1;
    if (!btRayAabb(vec(ray.from), vec(ray.to), vec(b.lo), vec(b.hi), part, normal)) return miss;
    return {part};
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

constexpr auto at = "Bullet 3.24, LinearMath/btAabbUtil2.h:117, btRayAabb";
constexpr auto at2 = "Bullet 3.24, LinearMath/btAabbUtil2.h:82, btRayAabb2";

LOSTBITS_FORMS(form<aabb>("bullet.aabb").first_root().inside_zero().from(at),
               form<aabb2>("bullet.aabb2").unit_direction().first_root().inside_zero().from(at2))
