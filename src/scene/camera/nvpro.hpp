// As NVIDIA's ray tracing tutorial for Vulkan makes the ray of a pixel.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// The stored view has -R e, rounded, for its last column, and the eye is what its inverse makes of that.
struct NvproRay {
    static constexpr MakerInfo info{
        .name = "nvpro",
        .title = "z = 1 through P^-1, made unit and turned by V^-1, both inverted in the format; the eye from V^-1",
        .source = "nvpro-samples/vk_raytracing_tutorial_KHR, ray_tracing__simple/shaders/raytrace.rgen",
    };

    template <class T>
    struct Inverses {
        Matrix4<T> projection, view;
    };
    template <Number T>
    static Inverses<T> prepare(const CameraNumbers<T>& camera) {
        return {inverse(camera.projection), inverse(camera.view)};
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Inverses<T>& from, const Pixel<T>& pixel) {
        const Vec<T> target = from.projection.point(clip_point(camera, pixel, T(1))).at;
        return {from.view.shift(), from.view.linear(unit(target))};
    }
};

}  // namespace lostbits::scene::camera
