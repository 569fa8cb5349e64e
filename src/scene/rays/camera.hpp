// Makes the rays of pixels, over any arithmetic: double for shared inputs, Real for the ideal scene.
#pragma once

#include <type_traits>

#include "geometry/ray.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::rays {

/// The camera of a picture, ready to make rays. It is computed once in Real, and each number is rounded once to T. So
/// the numbers are the same on every machine (no libm: MPFR's tangent is correctly rounded) and as accurate as T
/// allows.
template <class T>
struct CameraFrame {
    file::Camera::Kind kind;
    bool normalise;
    Vec<T> origin;
    /// An orthonormal basis. `up` is the camera's up made perpendicular to the view. Axis-aligned cameras get exact
    /// axes.
    Vec<T> right, up, forward;
    T pitch;     ///< side of a pixel, in world units; for a pinhole, at distance 1 in front of it
    T centre_x;  ///< x of the point where the view axis meets the picture, in pixels from its left edge
    T centre_y;  ///< y of the same point, in pixels down from the top edge
    /// pixel_plane: the top left corner of the picture at z = 0, and the height of a pixel (`pitch` is its width).
    T left, top, pitch_down;

    /// A frame with `f` applied to each number.
    template <class F>
    [[nodiscard]] auto convert_numbers(const F& f) const {
        using S = decltype(f(pitch));
        const auto vec = [&f](const Vec<T>& v) { return Vec<S>(f(v.x), f(v.y), f(v.z)); };
        return CameraFrame<S>{.kind = kind,
                              .normalise = normalise,
                              .origin = vec(origin),
                              .right = vec(right),
                              .up = vec(up),
                              .forward = vec(forward),
                              .pitch = f(pitch),
                              .centre_x = f(centre_x),
                              .centre_y = f(centre_y),
                              .left = f(left),
                              .top = f(top),
                              .pitch_down = f(pitch_down)};
    }
};

/// The frame of a scene's camera: forward ∥ look_at − eye, right ∥ forward × up, up = right × forward. A camera of
/// kind `pixel_plane` has no basis: its pixels are along x and y.
CameraFrame<Real> make_ideal_frame(const file::Scene& scene);

template <class T>
CameraFrame<T> make_frame(const file::Scene& scene) {
    static_assert(std::is_same_v<T, Real> || std::is_same_v<T, double>);
    if constexpr (std::is_same_v<T, Real>) return make_ideal_frame(scene);
    else
        return make_ideal_frame(scene).convert_numbers(
            [](const Real& x) { return toml::round_to_format(x, binary64); });
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
/// - orthographic: from origin + a·right + b·up in the direction `forward`;
/// - pinhole: from `origin` in the direction forward + a·right + b·up, divided by its length if `normalise`;
/// - pixel_plane: from `origin` in the direction pixel_point − origin.
///
/// The function uses only + − × ÷ √ in T, in the order in which these formulas are written, so the rounding is the same
/// on every machine.
template <class T>
Ray<T> ray(const CameraFrame<T>& frame, int x, int y) {
    if (frame.kind == file::Camera::Kind::pixel_plane) return {frame.origin, pixel_point(frame, x, y) - frame.origin};
    const T half = T(1) / T(2);
    const T a = (T(x) + half - frame.centre_x) * frame.pitch;
    const T b = (frame.centre_y - (T(y) + half)) * frame.pitch;
    const Vec<T> in_plane(a * frame.right.x + b * frame.up.x, a * frame.right.y + b * frame.up.y,
                          a * frame.right.z + b * frame.up.z);
    if (frame.kind == file::Camera::Kind::orthographic) return {frame.origin + in_plane, frame.forward};
    const Vec<T> direction = frame.forward + in_plane;
    if (!frame.normalise) return {frame.origin, direction};
    const T magnitude = length(direction);
    return {frame.origin, {direction.x / magnitude, direction.y / magnitude, direction.z / magnitude}};
}

}  // namespace lostbits::scene::rays
