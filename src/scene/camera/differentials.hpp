// The ray of a pixel from the differentials of the one to its left.
#pragma once

#include "scene/camera/pbrt.hpp"

namespace lostbits::scene::camera {

struct DifferentialsRay {
    static constexpr MakerInfo info{
        .name = "differentials",
        .title =
            "rxDirection of the pixel to the left: its point on the near plane plus dxCamera, made unit and turned",
        .source = "pbrt-v4, src/pbrt/cameras.h and cameras.cpp, PerspectiveCamera::GenerateRayDifferential",
    };

    /// dxCamera: how far a pixel is on the near plane.
    template <Number T>
    static Vec<T> prepare(const CameraNumbers<T>& camera) {
        const auto at = [&](int x) { return over_w(camera.raster_to_camera.point({T(x), T(0), T(0)})); };
        return at(1) - at(0);
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Vec<T>& step, const Pixel<T>& pixel) {
        const Vec<T> left = PbrtRay::on_near_plane(camera, Pixel<T>{pixel.left, pixel.y, pixel.left});
        return {camera.eye, camera.to_world.linear(unit(Vec<T>(left + step)))};
    }
};

}  // namespace lostbits::scene::camera
