// From pixels to rays, over any arithmetic: double for shared inputs, Real for the ideal scene.
#pragma once

#include <type_traits>

#include "geometry/ray.hpp"
#include "scene/file/scene.hpp"
#include "scene/file/stretch.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::rays {

/// The camera of a picture, ready to make rays. It is built once in Real and each number rounded once to T, so it
/// is the same on every machine (no libm: MPFR's tangent is correctly rounded) and as good as T allows.
template <class T>
struct CameraFrame {
    file::Camera::Kind kind;
    bool normalise;
    Vec<T> origin;
    /// An orthonormal basis; `up` is the camera's up made perpendicular to the view. Axis-aligned cameras get exact
    /// axes.
    Vec<T> right, up, forward;
    T pitch;     ///< side of a pixel: in world units, or at distance 1 in front of a pinhole
    T centre_x;  ///< where the view axis meets the picture: pixels right of its top left corner,
    T centre_y;  ///< and below it
    /// pixel_plane: the top left corner of the picture at z = 0, and the height of a pixel (`pitch` is its width).
    T left, top, pitch_down;
};

namespace detail {

template <class T>
T from_real(const Real& x) {
    static_assert(std::is_same_v<T, Real> || std::is_same_v<T, double>);
    if constexpr (std::is_same_v<T, Real>) return x;
    else return toml::round_to_format(x, binary64);
}

template <class T>
Vec<T> from_real(const Vec<Real>& v) {
    return {from_real<T>(v.x), from_real<T>(v.y), from_real<T>(v.z)};
}

/// v/|v|. The sum with zero turns −0, which cross products of axes give, into 0.
inline Vec<Real> unit(const Vec<Real>& v) {
    const Real size = length(v);
    const Real zero(0);
    return {v.x / size + zero, v.y / size + zero, v.z / size + zero};
}

}  // namespace detail

/// The camera of pixels at z = 0: no basis of its own, the pixels lie along x and y.
template <class T>
CameraFrame<T> make_pixel_frame(const file::Scene& scene) {
    const file::Camera& camera = scene.camera;
    using detail::from_real;
    CameraFrame<T> frame{};
    frame.kind = camera.kind;
    frame.normalise = false;
    frame.origin = from_real<T>(camera.eye);
    frame.left = from_real<T>(camera.left);
    frame.top = from_real<T>(camera.top);
    frame.pitch = from_real<T>((camera.right - camera.left) / Real(scene.width));
    frame.pitch_down = from_real<T>((camera.top - camera.bottom) / Real(scene.height));
    return frame;
}

/// The frame of a scene's camera: forward ∥ look_at − eye, right ∥ forward × up, up = right × forward.
template <class T>
CameraFrame<T> make_frame(const file::Scene& scene) {
    const file::Camera& camera = scene.camera;
    if (camera.kind == file::Camera::Kind::pixel_plane) return make_pixel_frame<T>(scene);
    const Vec<Real> forward = detail::unit(camera.look_at - camera.eye);
    const Vec<Real> right = detail::unit(cross(forward, camera.up));
    const Vec<Real> up = detail::unit(cross(right, forward));

    const Real width(scene.width);
    const Real height(scene.height);
    Real pitch;
    if (camera.kind == file::Camera::Kind::orthographic) {
        pitch = camera.width / width;
    } else {
        pitch = 2 * file::half_tangent(camera.fov_deg) / height;
    }
    const Real centre_x = width / 2 - camera.shift_right * width;
    const Real centre_y = height / 2 + camera.shift_up * width;

    using detail::from_real;
    return {.kind = camera.kind,
            .normalise = camera.normalise,
            .origin = from_real<T>(camera.eye),
            .right = from_real<T>(right),
            .up = from_real<T>(up),
            .forward = from_real<T>(forward),
            .pitch = from_real<T>(pitch),
            .centre_x = from_real<T>(centre_x),
            .centre_y = from_real<T>(centre_y),
            .left = T(0),
            .top = T(0),
            .pitch_down = T(0)};
}

/// pixel_plane: the middle of pixel (x, y) in the world, (left + (x + ½)·pitch, top − (y + ½)·pitch_down, 0).
template <class T>
Vec<T> pixel_point(const CameraFrame<T>& frame, int x, int y) {
    const T half = T(1) / T(2);
    return {frame.left + (T(x) + half) * frame.pitch, frame.top - (T(y) + half) * frame.pitch_down, T(0)};
}

/// The ray through the middle of pixel (x, y); x counts to the right from the left column, y down from the top row.
///
/// With a = (x + ½ − centre_x)·pitch to the right and b = (centre_y − (y + ½))·pitch upwards:
/// orthographic: origin + a·right + b·up, direction `forward`; pinhole: `origin`, direction forward + a·right + b·up,
/// divided by its length if `normalise`; pixel_plane: `origin`, direction pixel_point − origin. Only + − × ÷ √ in T, in
/// this order.
template <class T>
Ray<T> ray(const CameraFrame<T>& frame, int x, int y) {
    if (frame.kind == file::Camera::Kind::pixel_plane) return {frame.origin, pixel_point(frame, x, y) - frame.origin};
    const T half = T(1) / T(2);
    const T a = (T(x) + half - frame.centre_x) * frame.pitch;
    const T b = (frame.centre_y - (T(y) + half)) * frame.pitch;
    const Vec<T> aside(a * frame.right.x + b * frame.up.x, a * frame.right.y + b * frame.up.y,
                       a * frame.right.z + b * frame.up.z);
    if (frame.kind == file::Camera::Kind::orthographic) return {frame.origin + aside, frame.forward};
    const Vec<T> direction = frame.forward + aside;
    if (!frame.normalise) return {frame.origin, direction};
    const T size = length(direction);
    return {frame.origin, {direction.x / size, direction.y / size, direction.z / size}};
}

}  // namespace lostbits::scene::rays
