// As Godot makes the normal of a ray through a point of the viewport.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

struct GodotRay : AsStored {
    static constexpr MakerInfo info{
        .name = "godot",
        .title = "half extents of the near plane from P's diagonal, made unit, turned by the camera's basis, made unit",
        .source = "Godot, scene/3d/camera_3d.cpp, project_local_ray_normal and project_ray_normal",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        const auto& p = camera.projection.rows;
        const Vec<T> at = clip_point(camera, pixel, T(0));
        const Vec<T> local(at.x * (camera.near / p[0][0]), at.y * (camera.near / p[1][1]), -camera.near);
        return {camera.eye, unit(camera.to_world.linear(unit(local)))};
    }
};

}  // namespace lostbits::scene::camera
