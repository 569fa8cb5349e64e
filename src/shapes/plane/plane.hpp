// The plane: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/flat_span.hpp"
#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points p with n·(p − through) = 0, with n the normal. A ray may hit the plane from both sides. A line in the
/// plane misses it.
template <class T>
struct Plane {
    Vec<T> through;
    Vec<T> normal;

    static constexpr std::string_view name = "plane", plural = "planes";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a plane through (0, 0, -2), across the z axis",
                                      .touching_ray = "a ray along it",
                                      .degenerate = "a normal of 0",
                                      .anchor_points = "points"};
    static constexpr std::array<Key, 2> keys{
        {{.name = "through", .short_name = "q"},
         {.name = "normal", .short_name = "n", .kind = Key::Kind::direction, .limit = Key::Limit::not_zero}}};

    static Plane around(const Vec<T>& p, const T& half) { return {{p.x, p.y, p.z - half}, {T(0), T(0), T(1)}}; }

    [[nodiscard]] Vec<T> middle() const { return through; }
    [[nodiscard]] T half_extent() const { return T(1); }
    /// Returns a large ball for uses that need one. It does not contain the plane; `has_bounding_box` is false for
    /// planes.
    [[nodiscard]] Sphere<T> ball_around() const { return {through, T(0x1p100)}; }
    /// Returns the projection onto the plane of a point of the cube of side four around `through`.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        return project_onto_plane(through + Vec<T>(4 * u.x - 2, 4 * u.y - 2, 4 * u.z - 2));
    }
    [[nodiscard]] std::optional<Plane> scaled_about_nearest(const Vec<T>&, const T&) const { return *this; }

    /// t = n·(through − o)/(n·d). Numerator and denominator have degree two in the inputs, so for doubles each fits in
    /// 2 (1024 + 1074) + 3 < 4200 bits.
    [[nodiscard]] FlatSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), m = dot(normal, ray.direction), k = dot(normal, Vec<T>(through - ray.origin));
        const auto is_back = m > zero, is_front = m < zero, is_crossed = is_back || is_front;
        return {.at = {select(is_back, k, -k), select(is_back, m, -m)},
                .closed = is_crossed,
                .open = is_crossed,
                .is_front = is_front,
                .d2 = square(ray.direction)};
    }
    /// Returns the signed distance of a point from the plane, positive on the side that the normal points to.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        return dot(normal, Vec<T>(p - through)) / length(normal);
    }
    [[nodiscard]] T unit() const { return T(1); }
    [[nodiscard]] T distance(const Vec<T>& p) const { return abs(relative_distance(p)); }
    /// Returns the unit normal on the side that the ray comes from.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>&) const {
        const T size = length(normal);
        return (T(1) / (dot(normal, ray.direction) > T(0) ? -size : size)) * normal;
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_plane(p); }
    /// Returns the projected point with its error bound, which is that of the disc with f = p − through.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - through));
        BoundedPoint<T> bounded{project_onto_plane(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(12) * size + gamma_bound<T>(2) * abs(p[i]);
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> project_onto_plane(const Vec<T>& p) const {
        return p - (dot(normal, Vec<T>(p - through)) / square(normal)) * normal;
    }
};

}  // namespace lostbits
