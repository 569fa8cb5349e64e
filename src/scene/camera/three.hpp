// As three.js makes the ray of a pointer.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct ThreeRay : InvertsProjection {
    static constexpr MakerInfo info{
        .name = "three",
        .title =
            "z = 1/2 through P^-1, inverted in the format, then through the stored matrix of the camera; minus the "
            "eye",
        .source = "three.js, src/core/Raycaster.js setFromCamera, src/math/Vector3.js unproject",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const Vec<T> seen = times_over_w(from_clip.point(clip_point(camera, pixel, T(1) / T(2))));
        const Vec<T> eye = camera.to_world.shift();
        return {eye, unit_by_reciprocal(Vec<T>(camera.to_world.affine(seen) - eye))};
    }
};

}  // namespace lostbits::scene::camera
