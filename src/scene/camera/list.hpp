// The ray generators of renderers and engines, and the closed list of them.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// The ray of a pointer in three.js.
struct ThreeRay : InvertsProjection {
    static constexpr RayGeneratorInfo info{
        .name = "three",
        .title =
            "z = 1/2 through P^-1, inverted in the format, then through the stored matrix of the camera; minus the "
            "eye",
        .source = "three.js, src/core/Raycaster.js setFromCamera, src/math/Vector3.js unproject",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const Vec<T> point_ahead = multiply_by_reciprocal_w(from_clip.point(clip_point(camera, pixel, T(1) / T(2))));
        const Vec<T> eye = camera.to_world.shift();
        return {eye, unit_by_reciprocal(Vec<T>(camera.to_world.affine(point_ahead) - eye))};
    }
};

/// A picking ray in Babylon.js. The second point has z = 1 - 1e-8 for every range of depths: the point is behind the
/// near plane if z is reversed, and its z rounds to 1 in float.
struct BabylonRay : InvertsViewProjection {
    static constexpr RayGeneratorInfo info{
        .name = "babylon",
        .title = "(P V)^-1, product and inverse in the format; from the near plane to z = 1 - 1e-8",
        .source = "Babylon.js, packages/dev/core/src/Culling/ray.core.ts, unprojectRayToRef",
        .starts_on_near_plane = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto point_at = [&](const T& z) {
            return multiply_by_reciprocal_w(from_clip.point(clip_point(camera, pixel, z)));
        };
        const Vec<T> near = point_at(camera.depth_near), far = point_at(T(1) - T(1) / T(100000000));
        return {near, unit_by_reciprocal(Vec<T>(far - near))};
    }
};

/// Two calls of `unProject`, at the near plane and at the far plane, as in tutorials on picking.
struct GlmRay : InvertsViewProjection {
    static constexpr RayGeneratorInfo info{
        .name = "glm",
        .title = "(P V)^-1, product and inverse in the format; from the near plane to the far one",
        .source = "GLM 0.9.9.8, glm/ext/matrix_projection.inl:46 unProjectZO and :63 unProjectNO at depths 0 and 1",
        .starts_on_near_plane = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto point_at = [&](const T& z) { return unproject(camera, from_clip, pixel, z); };
        const Vec<T> near = point_at(camera.depth_near), far = point_at(camera.depth_far);
        return {near, unit_by_reciprocal(Vec<T>(far - near))};
    }
};

/// A camera's ray in the samples of DirectX Raytracing. z = 0 is the near plane if z runs from 0 to 1, and the far
/// plane if z is reversed.
struct DxrRay : InvertsViewProjection {
    static constexpr RayGeneratorInfo info{
        .name = "dxr",
        .title = "z = 0 through (P V)^-1, product and inverse in the format; minus the eye",
        .source = "DirectX-Graphics-Samples, Samples/Desktop/D3D12Raytracing, Raytracing.hlsl GenerateCameraRay",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const Vec<T> world = unproject(camera, from_clip, pixel, T(0));
        return {camera.eye, unit_of(Vec<T>(world - camera.eye))};
    }
};

/// A deprojected point of the screen in Unreal. Its depths, 1 and 0.01, are those of reversed z. For other depths the
/// same fractions between far and near are used.
struct UnrealRay {
    static constexpr RayGeneratorInfo info{
        .name = "unreal",
        .title = "(P V)^-1 inverted exactly and rounded once; from the near plane to reversed z = 0.01",
        .source = "Unreal Engine, FSceneView::DeprojectScreenToWorld, FCameraPoseMath::UnprojectFromScreen",
        .starts_on_near_plane = true,
    };

    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return camera.clip_to_world;
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto point_at = [&](const T& z) { return unproject(camera, from_clip, pixel, z); };
        const Vec<T> start = point_at(camera.depth_near), end = point_at(depth_at(camera, T(1) / T(100)));
        return {start, unit_by_reciprocal(Vec<T>(end - start))};
    }
};

/// The ray of a pointer in Bevy 0.9 to 0.16. Its depths, 1 and f32::EPSILON, are those of reversed z with the far
/// plane at infinity.
struct BevyRay {
    static constexpr RayGeneratorInfo info{
        .name = "bevy",
        .title = "the camera's matrix times P^-1, in the format; from the near plane to reversed z = 2^-23",
        .source = "Bevy 0.9 to 0.16, crates/bevy_render/src/camera/camera.rs, Camera::viewport_to_world",
        .starts_on_near_plane = true,
    };

    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return camera.to_world * inverse(camera.projection);
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto point_at = [&](const T& z) { return unproject(camera, from_clip, pixel, z); };
        const Vec<T> near = point_at(camera.depth_near), far = point_at(depth_at(camera, T(1) / T(8388608)));
        return {near, unit_of(Vec<T>(far - near))};
    }
};

/// The ray of a pointer in Bevy since 0.17: the difference is taken in the space of the camera.
struct BevyViewRay : InvertsProjection {
    static constexpr RayGeneratorInfo info{
        .name = "bevy_view",
        .title = "both points through P^-1, inverted in the format; their difference rotated, the near one moved",
        .source = "Bevy 0.17, crates/bevy_camera/src/camera.rs, Camera::viewport_to_world (pull request 20700)",
        .starts_on_near_plane = true,
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel) {
        const auto point_at = [&](const T& z) { return unproject(camera, from_clip, pixel, z); };
        const Vec<T> near = point_at(camera.depth_near), far = point_at(depth_at(camera, T(1) / T(8388608)));
        return {camera.to_world.affine(near), unit_of(camera.to_world.linear(Vec<T>(far - near)))};
    }
};

/// The ray of a pixel in NVIDIA's ray tracing tutorial for Vulkan. The last column of the stored view is -R e,
/// rounded, and the eye is computed from it by the inverse.
struct NvproRay {
    static constexpr RayGeneratorInfo info{
        .name = "nvpro",
        .title = "z = 1 through P^-1, normalised and rotated by V^-1, both inverted in the format; the eye from V^-1",
        .source = "nvpro-samples/vk_raytracing_tutorial_KHR, ray_tracing__simple/shaders/raytrace.rgen",
    };

    template <class T>
    struct Inverses {
        Matrix4<T> projection, view;
    };
    template <Number T>
    static Inverses<T> prepare(const CameraNumbers<T>& camera) {
        return {inverse(camera.projection), inverse(camera.view)};
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Inverses<T>& inverses, const Pixel<T>& pixel) {
        const Vec<T> target = inverses.projection.point(clip_point(camera, pixel, T(1))).xyz;
        return {inverses.view.shift(), inverses.view.linear(unit_of(target))};
    }
};

/// The normal of a ray through a point of the viewport in Godot.
struct GodotRay : PreparesNothing {
    static constexpr RayGeneratorInfo info{
        .name = "godot",
        .title =
            "half extents of the near plane from P's diagonal, normalised, rotated by the camera's basis, normalised",
        .source = "Godot, scene/3d/camera_3d.cpp, project_local_ray_normal and project_ray_normal",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        const auto& p = camera.projection.rows;
        const Vec<T> clip = clip_point(camera, pixel, T(0));
        const Vec<T> local(clip.x * (camera.near / p[0][0]), clip.y * (camera.near / p[1][1]), -camera.near);
        return {camera.eye, unit_of(camera.to_world.linear(unit_of(local)))};
    }
};

/// Three vectors across and into the picture, as in the samples of OptiX and many path tracers.
struct OptixRay : PreparesNothing {
    static constexpr RayGeneratorInfo info{
        .name = "optix",
        .title = "x U + y V + W, normalised; U and V are the tangents times the axes, in the format",
        .source = "OptiX SDK, SDK/optixPathTracer/optixPathTracer.cu __raygen__rg: normalize(d.x*U + d.y*V + W)",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        const Vec<T> clip = clip_point(camera, pixel, T(0));
        const Vec<T> u = camera.tan_x * camera.right, v = camera.tan_y * camera.up;
        return {camera.eye, unit_by_reciprocal(Vec<T>(clip.x * u + clip.y * v + camera.forward))};
    }
};

/// The middle of a pixel in the world and the vector to it from the eye, as in "Ray Tracing in One Weekend". The source
/// does not normalise directions. Here they are normalised, by a quotient for each component.
struct WeekendRay {
    static constexpr RayGeneratorInfo info{
        .name = "weekend",
        .title =
            "the middle of the pixel in the world, 10 in front of the eye, by steps from the first one; minus the "
            "eye",
        .source = "RayTracing/raytracing.github.io 4.0, src/InOneWeekend/camera.h, initialize and get_ray",
    };

    template <class T>
    struct Pixels {
        Vec<T> first, right, down;
    };
    template <Number T>
    static Pixels<T> prepare(const CameraNumbers<T>& camera) {
        const T distance(10), two(2), half = T(1) / T(2);
        const Vec<T> u = two * camera.tan_x * distance * camera.right, v = -(two * camera.tan_y * distance) * camera.up;
        const Vec<T> right = quotient(u, T(camera.width)), down = quotient(v, T(camera.height));
        const Vec<T> corner = camera.eye + distance * camera.forward - quotient(u, two) - quotient(v, two);
        return {corner + half * Vec<T>(right + down), right, down};
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Pixels<T>& pixels, const Pixel<T>& pixel) {
        const Vec<T> middle = pixels.first + pixel.x * pixels.right + pixel.y * pixels.down;
        return {camera.eye, unit_of(Vec<T>(middle - camera.eye))};
    }
};

/// The ray of pbrt's perspective camera, with the world moved so that the eye is its origin.
struct PbrtRay : PreparesNothing {
    static constexpr RayGeneratorInfo info{
        .name = "pbrt",
        .title =
            "the middle of the pixel through the stored matrix from raster to camera, normalised and rotated; the eye "
            "separate",
        .source = "pbrt-v4, src/pbrt/cameras.cpp, PerspectiveCamera::GenerateRay",
    };

    /// The middle of a pixel on the near plane, in the space of the camera.
    template <Number T>
    static Vec<T> point_on_near_plane(const CameraNumbers<T>& camera, const Pixel<T>& pixel) {
        const T half = T(1) / T(2);
        return divide_by_w(camera.raster_to_camera.point({pixel.x + half, pixel.y + half, T(0)}));
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        return {camera.eye, camera.to_world.linear(unit_of(point_on_near_plane(camera, pixel)))};
    }
};

/// The ray of a pixel from the differentials of the pixel to its left.
struct DifferentialsRay {
    static constexpr RayGeneratorInfo info{
        .name = "differentials",
        .title =
            "rxDirection of the pixel to the left: its point on the near plane plus dxCamera, normalised and rotated",
        .source = "pbrt-v4, src/pbrt/cameras.h and cameras.cpp, PerspectiveCamera::GenerateRayDifferential",
    };

    /// dxCamera: the width of a pixel on the near plane.
    template <Number T>
    static Vec<T> prepare(const CameraNumbers<T>& camera) {
        const auto near_plane_point = [&](int x) {
            return divide_by_w(camera.raster_to_camera.point({T(x), T(0), T(0)}));
        };
        return near_plane_point(1) - near_plane_point(0);
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Vec<T>& step, const Pixel<T>& pixel) {
        const Vec<T> left = PbrtRay::point_on_near_plane(camera, Pixel<T>{pixel.left, pixel.y, pixel.left});
        return {camera.eye, camera.to_world.linear(unit_of(Vec<T>(left + step)))};
    }
};

/// The inverse of projection and view without the position of the eye, which is added separately: camera-relative
/// rendering.
struct RelativeRay : PreparesNothing {
    static constexpr RayGeneratorInfo info{
        .name = "relative",
        .title = "(P R)^-1 inverted exactly and rounded once, R the view without its translation; the eye separate",
        .source =
            "Unity-Technologies/Graphics 4a193f6, com.unity.render-pipelines.high-definition/Documentation~/"
            "Camera-Relative-Rendering.md:9; Unreal's ScreenToTranslatedWorld",
    };

    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, int, const Pixel<T>& pixel) {
        return {camera.eye, unit_of(unproject(camera, camera.clip_to_offset, pixel, camera.depth_near))};
    }
};

/// Calls `act.template operator()<ThreeRay>()` for each ray generator in turn.
template <class Act>
constexpr void for_each_generator(const Act& act) {
    const auto act_on_all = [&act]<class... Generator>() { (act.template operator()<Generator>(), ...); };
    act_on_all.template operator()<ThreeRay,          //
                                   BabylonRay,        //
                                   GlmRay,            //
                                   DxrRay,            //
                                   UnrealRay,         //
                                   BevyRay,           //
                                   BevyViewRay,       //
                                   NvproRay,          //
                                   GodotRay,          //
                                   OptixRay,          //
                                   WeekendRay,        //
                                   PbrtRay,           //
                                   DifferentialsRay,  //
                                   RelativeRay>();
}

}  // namespace lostbits::scene::camera
