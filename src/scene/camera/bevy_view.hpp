// As Bevy makes the ray of a pointer since 0.17: the difference in the space of the camera.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct BevyViewRay : InvertsProjection {
    static constexpr MakerInfo info{
        .name = "bevy_view",
        .title = "both points through P^-1, inverted in the format; their difference turned, the near one moved",
        .source = "Bevy 0.17, crates/bevy_camera/src/camera.rs, Camera::viewport_to_world (pull request 20700)",
        .from_near = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto at = [&](const T& z) { return unprojected(camera, from_clip, pixel, z); };
        const Vec<T> near = at(camera.depth_near), far = at(depth_at(camera, T(1) / T(8388608)));
        return {camera.to_world.affine(near), unit(camera.to_world.linear(Vec<T>(far - near)))};
    }
};

}  // namespace lostbits::scene::camera
