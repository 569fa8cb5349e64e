// Embree 3.13.5, RTC_GEOMETRY_TYPE_SPHERE_POINT through rtcIntersect1 (kernels/geometry/sphere_intersector.h:40). The
// BVH above it must not lose the ray either. The manual: "a ray-sphere intersection ... hits from outside, and from
// inside the far side". float only. The scene holds one point, which is changed and committed when the sphere changes.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <embree3/rtcore.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

struct Scene {
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry points = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    void* at = rtcSetNewGeometryBuffer(points, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1);
    Scene() {
        std::memset(at, -1, 16), rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST), rtcAttachGeometry(scene, points);
    }
};
bool valid(const float (&v)[3]) { return std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]) < 1.8e18F; }

Answer<float> sphere(const Ray<float>& r, const Sphere<float>& s) {
    static thread_local Scene world;
    if (!valid(r.origin) || !valid(r.direction)) return miss;  // on larger ones Debian's library would end the program
    if (std::memcmp(world.at, &s, sizeof s) != 0) {
        std::memcpy(world.at, &s, sizeof s), rtcUpdateGeometryBuffer(world.points, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(world.points), rtcCommitScene(world.scene);
    }
    RTCIntersectContext context{};
    RTCRayHit ray{};
    ray.hit.geomID = context.instID[0] = RTC_INVALID_GEOMETRY_ID, ray.ray.tfar = r.end, ray.ray.mask = ~0U;
    std::copy_n(r.origin, 3, &ray.ray.org_x), std::copy_n(r.direction, 3, &ray.ray.dir_x);
    rtcIntersect1(world.scene, &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? miss : Answer<float>(ray.ray.tfar);
}

LOSTBITS_FORMS(form<sphere>("embree.sphere").first_root().from("Embree 3.13.5, sphere_intersector.h:40"))
