// As Babylon.js makes a picking ray.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// The second point has z = 1 - 1e-8 whatever the range of depths is: behind the near plane where z is reversed, and 1
/// itself in float.
struct BabylonRay : InvertsBoth {
    static constexpr MakerInfo info{
        .name = "babylon",
        .title = "(P V)^-1, product and inverse in the format; from the near plane to z = 1 - 1e-8",
        .source = "Babylon.js, packages/dev/core/src/Culling/ray.core.ts, unprojectRayToRef",
        .from_near = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto at = [&](const T& z) { return times_over_w(from_clip.point(clip_point(camera, pixel, z))); };
        const Vec<T> near = at(camera.depth_near), far = at(T(1) - T(1) / T(100000000));
        return {near, unit_by_reciprocal(Vec<T>(far - near))};
    }
};

}  // namespace lostbits::scene::camera
