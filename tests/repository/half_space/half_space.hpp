// The half space, an example of a new shape: recipe_shape.cmake copies this folder into a copy of src/shapes.
#pragma once

#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points p with n·(p − P) ≤ 0. It is unbounded.
template <class T>
struct HalfSpace {
    Vec<T> point;
    Vec<T> normal;

    static constexpr std::string_view name = "half_space", plural = "half spaces";
    static constexpr bool takes_tmax = false, inside_returns_zero = true, usually_takes_unit_direction = false,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a half space below z = -2",
                                      .touching_ray = "a ray along its plane",
                                      .degenerate = "a normal of 0",
                                      .anchor_points = "points and normals"};
    static constexpr std::array<Key, 2> keys{
        {{.name = "point", .short_name = "a"}, {.name = "normal", .short_name = "v", .kind = Key::Kind::direction}}};

    static HalfSpace around(const Vec<T>& p, const T& half) { return {{p.x, p.y, p.z - half}, {T(0), T(0), T(1)}}; }

    [[nodiscard]] Vec<T> middle() const { return point; }
    [[nodiscard]] T half_extent() const { return T(1); }
    [[nodiscard]] T unit() const { return T(1); }
    [[nodiscard]] Sphere<T> ball_around() const { return {point, T(0x1p100)}; }
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const { return onto(point + T(2) * u); }
    [[nodiscard]] std::optional<HalfSpace> scaled_about_nearest(const Vec<T>&, const T&) const { return *this; }

    /// From t = n·(P − o)/(n·d) on if n·d < 0, up to it if n·d > 0. A parallel line lies in it entirely or not at all.
    [[nodiscard]] SlabSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), one(1), n = dot(normal, point - ray.origin), m = dot(normal, ray.direction);
        const auto never = zero<zero, out = m> zero, in = m < zero;
        const Fraction<T> before{-one, zero}, after{one, zero};
        return {.entry = {select(in, {-n, -m}, before), before, before},
                .exit = {select(out, {n, m}, after), after, after},
                .crossed = {in || out, never, never},
                .closed = in || out || n >= zero,
                .open = in || out || n > zero,
                .d2 = square(ray.direction)};
    }
    [[nodiscard]] T relative_distance(const Vec<T>& p) const { return dot(normal, p - point) / length(normal); }
    [[nodiscard]] T distance(const Vec<T>& p) const { return relative_distance(p); }
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>&) const { return (T(1) / length(normal)) * normal; }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return onto(p); }
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>& ray, const T& t, const Vec<T>& p) const {
        BoundedPoint<T> b{p, p};
        for (int i = 0; i < 3; ++i) b.delta[i] = gamma_bound<T>(9) * (abs(t * ray.direction[i]) + abs(p[i]));
        return b;
    }

private:
    [[nodiscard]] Vec<T> onto(const Vec<T>& p) const { return p - (dot(normal, p - point) / square(normal)) * normal; }
};

}  // namespace lostbits
