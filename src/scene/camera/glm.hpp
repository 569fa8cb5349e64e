// Two calls of `unProject`, at the near plane and at the far one: as tutorials of picking have it.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct GlmRay : InvertsBoth {
    static constexpr MakerInfo info{
        .name = "glm",
        .title = "(P V)^-1, product and inverse in the format; from the near plane to the far one",
        .source = "GLM 0.9.9.8, glm/ext/matrix_projection.inl:46 unProjectZO and :63 unProjectNO at depths 0 and 1",
        .from_near = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto at = [&](const T& z) { return unprojected(camera, from_clip, pixel, z); };
        const Vec<T> near = at(camera.depth_near), far = at(camera.depth_far);
        return {near, unit_by_reciprocal(Vec<T>(far - near))};
    }
};

}  // namespace lostbits::scene::camera
