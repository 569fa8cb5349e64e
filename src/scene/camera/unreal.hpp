// As Unreal deprojects a point of the screen.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Its depths, 1 and 0.01, are those of reversed z; of others the same shares between far and near.
struct UnrealRay {
    static constexpr MakerInfo info{
        .name = "unreal",
        .title = "(P V)^-1 inverted exactly and rounded once; from the near plane to reversed z = 0.01",
        .source = "Unreal Engine, FSceneView::DeprojectScreenToWorld, FCameraPoseMath::UnprojectFromScreen",
        .from_near = true,
    };

    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return camera.clip_to_world;
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto at = [&](const T& z) { return unprojected(camera, from_clip, pixel, z); };
        const Vec<T> start = at(camera.depth_near), end = at(depth_at(camera, T(1) / T(100)));
        return {start, unit_by_reciprocal(Vec<T>(end - start))};
    }
};

}  // namespace lostbits::scene::camera
