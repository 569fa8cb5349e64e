// The inputs of a ray generator: a camera as a program stores it, and the steps that most ray generators share.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/ray.hpp"
#include "geometry/vec.hpp"

namespace lostbits::scene::camera {

/// A point before division by w.
template <class T>
struct Homogeneous {
    Vec<T> xyz;
    T w;
};

/// A matrix of four rows, in the format T.
template <class T>
struct Matrix4 {
    std::array<std::array<T, 4>, 4> rows;

    /// Computes ((a x + b y) + c z) + d for each row a b c d.
    [[nodiscard]] Homogeneous<T> point(const Vec<T>& p) const {
        const auto row = [&](std::size_t i) {
            return rows[i][0] * p.x + rows[i][1] * p.y + rows[i][2] * p.z + rows[i][3];
        };
        return {{row(0), row(1), row(2)}, row(3)};
    }
    /// Transforms a point by a matrix whose last row is 0 0 0 1.
    [[nodiscard]] Vec<T> affine(const Vec<T>& p) const { return point(p).xyz; }
    [[nodiscard]] Vec<T> linear(const Vec<T>& v) const {
        const auto row = [&](std::size_t i) { return rows[i][0] * v.x + rows[i][1] * v.y + rows[i][2] * v.z; };
        return {row(0), row(1), row(2)};
    }
    [[nodiscard]] Vec<T> shift() const { return {rows[0][3], rows[1][3], rows[2][3]}; }

    /// Applies `f` to each number, row by row, and returns a matrix of the results.
    template <class F>
    [[nodiscard]] auto each(const F& f) const {
        return Matrix4<decltype(f(rows[0][0]))>::of([&](std::size_t i, std::size_t j) { return f(rows[i][j]); });
    }
    template <class F>
    static Matrix4 of(const F& f) {
        const auto row = [&f](std::size_t i) { return std::array<T, 4>{f(i, 0), f(i, 1), f(i, 2), f(i, 3)}; };
        return {{row(0), row(1), row(2), row(3)}};
    }
};

/// The product that applies first b, then a: sums of four products, left to right.
template <class T>
Matrix4<T> operator*(const Matrix4<T>& a, const Matrix4<T>& b) {
    return Matrix4<T>::of([&](std::size_t i, std::size_t j) {
        const auto& row = a.rows[i];
        return row[0] * b.rows[0][j] + row[1] * b.rows[1][j] + row[2] * b.rows[2][j] + row[3] * b.rows[3][j];
    });
}

/// adj(M) times 1/det(M), with minors from differences of two products, as in GLM, glam and Babylon.
template <class T>
Matrix4<T> inverse(const Matrix4<T>& m) {
    const auto& a = m.rows;
    const auto two_by_two = [&a](std::size_t upper_row, std::size_t j, std::size_t k) {
        return a[upper_row][j] * a[upper_row + 1][k] - a[upper_row][k] * a[upper_row + 1][j];
    };
    const auto cofactor = [&](std::size_t i, std::size_t j) {
        const std::size_t x = j == 0 ? 1 : 0, y = j <= 1 ? 2 : 1, z = j == 3 ? 2 : 3;
        const std::size_t other_row = i ^ 1, pair_row = i < 2 ? 2 : 0;
        const auto& row = a[other_row];
        const T minor = row[x] * two_by_two(pair_row, y, z) - row[y] * two_by_two(pair_row, x, z) +
                        row[z] * two_by_two(pair_row, x, y);
        return (i + j) % 2 == 0 ? minor : T(-minor);
    };
    const auto adjugate = Matrix4<T>::of([&](std::size_t i, std::size_t j) { return cofactor(j, i); });
    const auto term = [&](std::size_t j) { return a[0][j] * adjugate.rows[j][0]; };
    const T reciprocal_det = T(1) / ((term(0) + term(1)) + (term(2) + term(3)));
    return adjugate.each([&](const T& x) -> T { return x * reciprocal_det; });
}

/// The properties of a ray generator.
struct RayGeneratorInfo {
    std::string_view name;  ///< unique; `three` in `sphere.unified@ray-three`
    std::string_view title;
    std::string_view source;
    bool starts_on_near_plane = false;  ///< true if the rays begin on the near plane, not at the eye
};

/// A pinhole camera in a format. Every number is computed exactly from the numbers of the scene, and rounded once. In
/// clip space x points to the right and y up. The camera looks along -z of its own space.
template <class T>
struct CameraNumbers {
    int width, height;               ///< pixels
    Vec<T> eye, right, up, forward;  ///< right, up and forward have length one
    T tan_x, tan_y;                  ///< half of the picture's width and height, at distance 1 in front of the eye
    T near;
    T depth_near, depth_far;  ///< z over w of the near and far planes in clip space
    Matrix4<T> view;          ///< from the world to the camera's space
    Matrix4<T> projection;    ///< from the camera's space to clip space
    Matrix4<T> to_world;      ///< the inverse of `view`: the axes and the eye
    /// The inverse of projection times view, and this inverse with the eye at the origin of the world.
    Matrix4<T> clip_to_world, clip_to_offset;
    /// From pixels, to the right and down, to the camera's space; z is 0 on the near plane.
    Matrix4<T> raster_to_camera;

    /// Applies `f` to each number, in this order.
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

/// The names of the numbers, in the order of `CameraNumbers::each`: `eye.x`, `tan_x`, `view.r0c3`.
std::vector<std::string> camera_number_names();

/// Position of a pixel: x counts to the right from the left column, y down from the top row.
template <class T>
struct Pixel {
    T x, y;
    T left;  ///< x of the pixel to the left, x - 1
};

/// Base of ray generators that make no matrix of their own. They ignore the value that `prepare` returns.
struct PreparesNothing {
    template <Number T>
    static int prepare(const CameraNumbers<T>&) {
        return 0;
    }
};

/// Base of ray generators that invert only the projection in the format.
struct InvertsProjection {
    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return inverse(camera.projection);
    }
};

/// Base of ray generators that compute the product of both matrices and its inverse, (P V)^-1, in the format.
struct InvertsViewProjection {
    template <Number T>
    static Matrix4<T> prepare(const CameraNumbers<T>& camera) {
        return inverse(camera.projection * camera.view);
    }
};

/// The middle of a pixel in clip space, divided by w: (x + 1/2)/width * 2 - 1, and the same formula for y, negated.
template <Number T>
Vec<T> clip_point(const CameraNumbers<T>& camera, const Pixel<T>& pixel, const T& z) {
    const T half = T(1) / T(2), two(2), one(1);
    return {(pixel.x + half) / T(camera.width) * two - one, -((pixel.y + half) / T(camera.height) * two - one), z};
}

/// The depth at a fraction between the far plane (0) and the near plane (1). For reversed z it is the fraction itself.
template <Number T>
T depth_at(const CameraNumbers<T>& camera, const T& fraction) {
    return camera.depth_far + fraction * (camera.depth_near - camera.depth_far);
}

template <Number T>
Vec<T> quotient(const Vec<T>& v, const T& divisor) {
    return {v.x / divisor, v.y / divisor, v.z / divisor};
}
template <Number T>
Vec<T> divide_by_w(const Homogeneous<T>& p) {
    return quotient(p.xyz, p.w);
}
/// Multiplies by 1/w.
template <Number T>
Vec<T> multiply_by_reciprocal_w(const Homogeneous<T>& p) {
    return T(1) / p.w * p.xyz;
}

/// Transforms the middle of a pixel at a depth by a matrix, and divides by w.
template <Number T>
Vec<T> unproject(const CameraNumbers<T>& camera, const Matrix4<T>& from_clip, const Pixel<T>& pixel, const T& z) {
    return divide_by_w(from_clip.point(clip_point(camera, pixel, z)));
}

/// v/|v|, computed as v multiplied by the rounded 1/|v|. `unit_of` divides each component by |v| instead.
template <Number T>
Vec<T> unit_by_reciprocal(const Vec<T>& v) {
    return T(1) / length(v) * v;
}

}  // namespace lostbits::scene::camera
