// What a way to make rays is given: a camera as a program stores it, and the steps that most ways share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/ray.hpp"
#include "scene/camera/matrix4.hpp"

namespace lostbits::scene::camera {

/// What a way says of itself.
struct MakerInfo {
    std::string_view name;  ///< `three` of `sphere.unified@ray.three`, unique
    std::string_view title;
    std::string_view source;
    bool from_near = false;  ///< its rays begin on the near plane, not at the eye
};

/// A pinhole camera in a format: every number made from the scene's in exact numbers and rounded once. Clip space has x
/// to the right and y up; the camera looks along -z of its own space.
template <class T>
struct CameraNumbers {
    int width, height;               ///< pixels
    Vec<T> eye, right, up, forward;  ///< the last three of length one
    T tan_x, tan_y;                  ///< half of the picture's width and height, 1 in front of the eye
    T near;
    T depth_near, depth_far;  ///< z of both planes in clip space over w
    Matrix4<T> view;          ///< from the world to the camera's space
    Matrix4<T> projection;    ///< from there to clip space
    Matrix4<T> to_world;      ///< the inverse of `view`: the axes and the eye
    /// The inverse of projection times view; the same where the eye is the origin of the world.
    Matrix4<T> clip_to_world, clip_to_offset;
    Matrix4<T> raster_to_camera;  ///< pixels to the right and down, and z from 0 on the near plane

    /// Each number through `f`, in this order.
    template <class F>
    [[nodiscard]] auto each(const F& f) const {
        using S = decltype(f(near));
        const auto vec = [&f](const Vec<T>& v) { return Vec<S>{f(v.x), f(v.y), f(v.z)}; };
        return CameraNumbers<S>{.width = width,
                                .height = height,
                                .eye = vec(eye),
                                .right = vec(right),
                                .up = vec(up),
                                .forward = vec(forward),
                                .tan_x = f(tan_x),
                                .tan_y = f(tan_y),
                                .near = f(near),
                                .depth_near = f(depth_near),
                                .depth_far = f(depth_far),
                                .view = view.each(f),
                                .projection = projection.each(f),
                                .to_world = to_world.each(f),
                                .clip_to_world = clip_to_world.each(f),
                                .clip_to_offset = clip_to_offset.each(f),
                                .raster_to_camera = raster_to_camera.each(f)};
    }
};

/// What the numbers are called, in the order of `CameraNumbers::each`: `eye.x`, `tan_x`, `view.r0c3`.
std::vector<std::string> camera_number_names();

/// x counts to the right from the left column, y down from the top row.
template <class T>
struct Pixel {
    T x, y;
    T left;  ///< x - 1
};

/// For ways that make no matrix of their own.
struct AsStored {
    template <Number T>
    static int prepare(const CameraNumbers<T>&) {
        return 0;
    }
};

/// For ways that invert the projection alone, in the format.
struct InvertsProjection {
    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return inverse(camera.projection);
    }
};

/// For ways whose product of both matrices and its inverse, (P V)^-1, are made in the format.
struct InvertsBoth {
    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return inverse(camera.projection * camera.view);
    }
};

/// The middle of a pixel in clip space over w: (x + 1/2)/width * 2 - 1, and the same of y, negated.
template <Number T>
Vec<T> clip_point(const CameraNumbers<T>& camera, const Pixel<T>& pixel, const T& z) {
    const T half = T(1) / T(2), two(2), one(1);
    return {(pixel.x + half) / T(camera.width) * two - one, -((pixel.y + half) / T(camera.height) * two - one), z};
}

/// Between the far plane (0) and the near one (1): of reversed z the depth itself.
template <Number T>
T depth_at(const CameraNumbers<T>& camera, const T& share) {
    return camera.depth_far + share * (camera.depth_near - camera.depth_far);
}

template <Number T>
Vec<T> over(const Vec<T>& v, const T& by) {
    return {v.x / by, v.y / by, v.z / by};
}
template <Number T>
Vec<T> over_w(const Homogeneous<T>& p) {
    return over(p.at, p.w);
}
/// Multiplied by 1/w.
template <Number T>
Vec<T> times_over_w(const Homogeneous<T>& p) {
    return T(1) / p.w * p.at;
}

/// What a matrix makes of the middle of a pixel at a depth, over w.
template <Number T>
Vec<T> unprojected(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel, const T& z) {
    return over_w(from_clip.point(clip_point(camera, pixel, z)));
}

/// v/|v|, each component a quotient; and multiplied by 1/|v|.
template <Number T>
Vec<T> unit(const Vec<T>& v) {
    return over(v, T(length(v)));
}
template <Number T>
Vec<T> unit_by_reciprocal(const Vec<T>& v) {
    return T(1) / length(v) * v;
}

}  // namespace lostbits::scene::camera
