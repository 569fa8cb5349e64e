// Two calls of `unProject`, at the near plane and at the far one: as tutorials of picking have it.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct GlmRay {
    static constexpr MakerInfo info{
        .name = "glm",
        .title = "(P V)^-1, product and inverse in the format; from the near plane to the far one",
        .source = "GLM, glm/ext/matrix_projection.inl, unProjectZO and unProjectNO at depths 0 and 1",
        .from_near = true,
    };

    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return inverse(camera.projection * camera.view);
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel& pixel) {
        const auto at = [&](const T& z) { return over_w(from_clip.point(clip_point(camera, pixel, z))); };
        const Vec<T> near = at(camera.depth_near), far = at(camera.depth_far);
        return {near, unit_by_reciprocal(Vec<T>(far - near))};
    }
};

}  // namespace lostbits::scene::camera
