// As "Ray Tracing in One Weekend" finds the middle of a pixel in the world, and the way there from the eye.
#pragma once

#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Its directions are not made unit there; here they are, by a quotient for each component.
struct WeekendRay {
    static constexpr MakerInfo info{
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
        const Vec<T> right = over(u, T(camera.width)), down = over(v, T(camera.height));
        const Vec<T> corner = camera.eye + distance * camera.forward - over(u, two) - over(v, two);
        return {corner + half * Vec<T>(right + down), right, down};
    }
    template <Number T>
    static Ray<T> ray(const CameraNumbers<T>& camera, const Pixels<T>& pixels, const Pixel<T>& pixel) {
        const Vec<T> middle = pixels.first + pixel.x * pixels.right + pixel.y * pixels.down;
        return {camera.eye, unit(Vec<T>(middle - camera.eye))};
    }
};

}  // namespace lostbits::scene::camera
