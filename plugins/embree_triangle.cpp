// Embree 3.13.5, RTC_GEOMETRY_TYPE_TRIANGLE through rtcIntersect1, float only. By default it is Moller and Trumbore's
// test (kernels/geometry/triangle_intersector_moeller.h:69). With RTC_SCENE_FLAG_ROBUST, which "avoids optimizations
// that reduce arithmetic accuracy", it uses Pluecker coordinates (triangle_intersector_pluecker.h:69). Both are also
// called through rtcIntersect8 if many rays are tested against one triangle. The scene holds one triangle, which is
// committed when it changes.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <embree3/rtcore.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

struct Scene {
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* at = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3);
    explicit Scene(RTCSceneFlags flags) {
        const unsigned order[3] = {0, 1, 2};
        std::memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 1), order, 12);
        std::memset(at, -1, 36), rtcSetSceneFlags(scene, flags), rtcAttachGeometry(scene, mesh);
    }
};
template <RTCSceneFlags flags>
RTCScene scene_of(const float* vertices) {
    static thread_local Scene world(flags);
    if (std::memcmp(world.at, vertices, 36) != 0) {
        std::memcpy(world.at, vertices, 36), rtcUpdateGeometryBuffer(world.mesh, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(world.mesh), rtcCommitScene(world.scene);
    }
    return world.scene;
}
RTCIntersectContext fresh() {
    RTCIntersectContext context{};
    context.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return context;
}
bool valid(const float* r) {  // on larger ones Debian's library would end the program
    return std::all_of(r, r + 6, [](float x) { return std::fabs(x) < 6e17F; });
}

template <RTCSceneFlags flags>
Answer<float> triangle(const Ray<float>& r, const Triangle<float>& s) {
    if (!valid(r.origin)) return miss;  // origin and direction, which lie side by side
    RTCIntersectContext context = fresh();
    RTCRayHit ray{};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID, ray.ray.tfar = r.end, ray.ray.mask = ~0U;
    std::copy_n(r.origin, 3, &ray.ray.org_x), std::copy_n(r.direction, 3, &ray.ray.dir_x);
    rtcIntersect1(scene_of<flags>(s.a), &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? miss : Answer<float>(ray.ray.tfar);
}
template <RTCSceneFlags flags>
const char* packs(const lb_batch* b) {
    const auto *ray = static_cast<const float*>(b->rays), *ends = static_cast<const float*>(b->ends);
    for (std::size_t i = 0, n = 0; i < b->size; i += n) {
        n = b->primitive_stride == 0 ? std::min<std::size_t>(8, b->size - i) : 1;
        alignas(32) int valid_lanes[8] = {};
        RTCRayHit8 all{};
        for (std::size_t k = 0; k < n; ++k, ray += 6) {
            valid_lanes[k] = valid(ray) ? -1 : 0, all.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID, all.ray.mask[k] = ~0U;
            all.ray.org_x[k] = ray[0], all.ray.org_y[k] = ray[1], all.ray.org_z[k] = ray[2];
            all.ray.dir_x[k] = ray[3], all.ray.dir_y[k] = ray[4], all.ray.dir_z[k] = ray[5];
            all.ray.tfar[k] = ends ? ends[i + k] : INFINITY;
        }
        RTCIntersectContext context = fresh();
        rtcIntersect8(valid_lanes, scene_of<flags>(static_cast<const float*>(b->primitives) + i * b->primitive_stride),
                      &context, &all);
        for (std::size_t k = 0; k < n; ++k) {
            b->hit[i + k] = valid_lanes[k] != 0 && all.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
            static_cast<float*>(b->near_far)[2 * (i + k)] = all.ray.tfar[k];
        }
    }
    return nullptr;
}

template <RTCSceneFlags flags>
constexpr Form one(const char* name) {
    return form<triangle<flags>>(name).first_root();
}
template <RTCSceneFlags flags>
constexpr Form eight(const char* name) {
    Form made = one<flags>(name);
    made.run = packs<flags>;
    return made;
}
constexpr auto plain = RTC_SCENE_FLAG_NONE, robust = RTC_SCENE_FLAG_ROBUST;
constexpr auto at = "Embree 3.13.5, triangle_intersector_moeller.h:69",
               at_robust = "Embree 3.13.5, triangle_intersector_pluecker.h:69";

LOSTBITS_FORMS(one<plain>("embree.triangle").origin_misses().from(at),
               one<robust>("embree.triangle_robust").from(at_robust),
               eight<plain>("embree.triangle8").origin_misses().from(at),
               eight<robust>("embree.triangle8_robust").from(at_robust))
