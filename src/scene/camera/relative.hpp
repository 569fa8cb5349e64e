// The inverse of projection and view without the eye's place, and the eye apart: camera-relative rendering.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct RelativeRay : AsStored {
    static constexpr MakerInfo info{
        .name = "relative",
        .title = "(P R)^-1 inverted exactly and rounded once, R the view without its translation; the eye apart",
        .source =
            "Unity-Technologies/Graphics 4a193f6, com.unity.render-pipelines.high-definition/Documentation~/"
            "Camera-Relative-Rendering.md:9; Unreal's ScreenToTranslatedWorld",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        return {camera.eye, unit(unprojected(camera, camera.clip_to_offset, pixel, camera.depth_near))};
    }
};

}  // namespace lostbits::scene::camera
