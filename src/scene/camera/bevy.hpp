// As Bevy made the ray of a pointer from 0.9 to 0.16.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Its depths, 1 and f32::EPSILON, are those of reversed z with the far plane at infinity.
struct BevyRay {
    static constexpr MakerInfo info{
        .name = "bevy",
        .title = "the camera's matrix times P^-1, in the format; from the near plane to reversed z = 2^-23",
        .source = "Bevy 0.9 to 0.16, crates/bevy_render/src/camera/camera.rs, Camera::viewport_to_world",
        .from_near = true,
    };

    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return camera.to_world * inverse(camera.projection);
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto at = [&](const T& z) { return unprojected(camera, from_clip, pixel, z); };
        const Vec<T> near = at(camera.depth_near), far = at(depth_at(camera, T(1) / T(8388608)));
        return {near, unit(Vec<T>(far - near))};
    }
};

}  // namespace lostbits::scene::camera
