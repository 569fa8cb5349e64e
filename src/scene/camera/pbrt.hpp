// As pbrt's perspective camera makes a ray, where the world is moved so that the eye is its origin.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct PbrtRay : AsStored {
    static constexpr MakerInfo info{
        .name = "pbrt",
        .title =
            "the middle of the pixel through the stored matrix from raster to camera, made unit and turned; the eye "
            "apart",
        .source = "pbrt-v4, src/pbrt/cameras.cpp, PerspectiveCamera::GenerateRay",
    };

    /// The middle of a pixel on the near plane, in the space of the camera.
    template <Number T>
    static Vec<T> on_near_plane(const CameraNumbers<T>& camera, const Pixel<T>& pixel) {
        const T half = T(1) / T(2);
        return over_w(camera.raster_to_camera.point({pixel.x + half, pixel.y + half, T(0)}));
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        return {camera.eye, camera.to_world.linear(unit(on_near_plane(camera, pixel)))};
    }
};

}  // namespace lostbits::scene::camera
