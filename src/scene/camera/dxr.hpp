// As the samples of DirectX Raytracing make a camera's ray.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// z = 0 is the near plane where z runs from 0 to 1, and the far one where it is reversed.
struct DxrRay : InvertsBoth {
    static constexpr MakerInfo info{
        .name = "dxr",
        .title = "z = 0 through (P V)^-1, product and inverse in the format; minus the eye",
        .source = "DirectX-Graphics-Samples, Samples/Desktop/D3D12Raytracing, Raytracing.hlsl GenerateCameraRay",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const Vec<T> world = unprojected(camera, from_clip, pixel, T(0));
        return {camera.eye, unit(Vec<T>(world - camera.eye))};
    }
};

}  // namespace lostbits::scene::camera
