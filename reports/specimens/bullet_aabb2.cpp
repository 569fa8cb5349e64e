// Bullet 3.24, LinearMath/btAabbUtil2.h:82, btRayAabb2: a ray in the plane of a low face meets the box and one in the
// plane of a high face misses it, a flat box is never met, and so on: (1) 1/0 is 1e18 (btCollisionWorld.cpp:815), so
// the plane at distance 0 gives 0 and not NaN or infinity, (2) `tmin < lambda_max && tmax > lambda_min` is strict.
//   g++ bullet_aabb2.cpp $(pkg-config --cflags bullet) && ./a.out
#include <cstdio>

#include <LinearMath/btAabbUtil2.h>

bool meets(const btVector3& from, const btVector3& d, const btVector3& lo, const btVector3& hi) {
    btVector3 over;
    unsigned sign[3];
    for (int k = 0; k < 3; ++k) over[k] = d[k] == 0 ? btScalar(BT_LARGE_FLOAT) : 1 / d[k], sign[k] = over[k] < 0;
    const btVector3 bounds[2] = {lo, hi};
    btScalar t = 0;
    return btRayAabb2(from, over, sign, bounds, t, 0, 100);
}
bool meets_first(const btVector3& from, const btVector3& d, const btVector3& lo, const btVector3& hi) {
    btScalar part = 1;
    btVector3 normal;
    return btRayAabb(from, from + 100 * d, lo, hi, part, normal);
}

int main() {
    const btVector3 lo(-1, -1, -1), hi(1, 1, 1), along(1, 0, 0);
    const auto show = [](const char* what, bool second, bool first) {
        std::printf("%s: btRayAabb2 %s, btRayAabb %s\n", what, second ? "hit" : "miss", first ? "hit" : "miss");
    };
    show("in the face y = -1", meets({-3, -1, 0}, along, lo, hi), meets_first({-3, -1, 0}, along, lo, hi));
    show("in the face y = +1", meets({-3, 1, 0}, along, lo, hi), meets_first({-3, 1, 0}, along, lo, hi));
    show("through the middle of a flat box, in its plane", meets({-3, 0, 0}, along, {-1, 0, -1}, {1, 0, 1}),
         meets_first({-3, 0, 0}, along, {-1, 0, -1}, {1, 0, 1}));
    show("from its high face outwards, touching it", meets({1, 0, 0}, along, lo, hi),
         meets_first({1, 0, 0}, along, lo, hi));
}
