// The inverse of projection and view without the eye's place, and the eye apart: camera-relative rendering.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct RelativeRay : AsStored {
    static constexpr MakerInfo info{
        .name = "relative",
        .title = "(P R)^-1 inverted exactly and rounded once, R the view without its translation; the eye apart",
        .source = "Unity High Definition Render Pipeline, Camera-relative rendering; Unreal's ScreenToTranslatedWorld",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel& pixel) {
        return {camera.eye, unit(over_w(camera.clip_to_offset.point(clip_point(camera, pixel, camera.depth_near))))};
    }
};

}  // namespace lostbits::scene::camera
