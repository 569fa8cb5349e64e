// Embree 3.13.5, RTC_GEOMETRY_TYPE_SPHERE_POINT through rtcIntersect1 (kernels/geometry/sphere_intersector.h:60), with a
// BVH above it that must not lose the ray either. The manual: "a ray-sphere intersection ... hits from outside, and from
// inside the far side". float alone. A scene of one point, changed and committed wherever the sphere changes.
#include <cmath>
#include <cstring>

#include <embree3/rtcore.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

struct Scene {
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry points = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float* at = static_cast<float*>(rtcSetNewGeometryBuffer(points, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1));
    Sphere<float> now{};
    Scene() { rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST), rtcAttachGeometry(scene, points); }
    void hold(const Sphere<float>& s) {
        if (std::memcmp(&now, &s, sizeof s) == 0) return;
        std::memcpy(at, &s, sizeof s), now = s;
        rtcUpdateGeometryBuffer(points, RTC_BUFFER_TYPE_VERTEX, 0), rtcCommitGeometry(points), rtcCommitScene(scene);
    }
};
Answer<float> sphere(const Ray<float>& r, const Sphere<float>& s) {
    for (int k = 0; k < 3; ++k)  // Debian's Embree ends the program on a ray that is not valid
        if (!(std::fabs(r.origin[k]) < 1.844e18F && std::fabs(r.direction[k]) < 1.844e18F)) return miss;
    static thread_local Scene world;
    world.hold(s);
    RTCRayHit ray{{r.origin[0], r.origin[1], r.origin[2], 0, r.direction[0], r.direction[1], r.direction[2], 0, r.end,
                   ~0U, 0, 0}, {}};
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(world.scene, &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? miss : Answer<float>(ray.ray.tfar);
}

LOSTBITS_FORMS(form<sphere>("embree.sphere").first_root().titled("a sphere point of Embree").from(
    "Embree 3.13.5, kernels/geometry/sphere_intersector.h:60"))
