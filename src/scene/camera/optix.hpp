// Three vectors across and into the picture: as the samples of OptiX have it, and many path tracers.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct OptixRay : AsStored {
    static constexpr MakerInfo info{
        .name = "optix",
        .title = "x U + y V + W, made unit; U and V are the tangents times the axes, in the format",
        .source = "OptiX SDK, SDK/optixPathTracer/optixPathTracer.cu __raygen__rg: normalize(d.x*U + d.y*V + W)",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        const Vec<T> at = clip_point(camera, pixel, T(0));
        const Vec<T> u = camera.tan_x * camera.right, v = camera.tan_y * camera.up;
        return {camera.eye, unit_by_reciprocal(Vec<T>(at.x * u + at.y * v + camera.forward))};
    }
};

}  // namespace lostbits::scene::camera
