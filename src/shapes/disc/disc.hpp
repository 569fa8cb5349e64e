// The disc: its numbers, its exact span on a ray, and its distances.
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

/// All points of the plane through `centre` across `normal` that are no farther from the centre than `outer_radius` > 0
/// and no nearer than `inner_radius` ≥ 0. The disc is closed, and a ray may hit it from both sides. With an inner
/// radius it is an annulus. A line in its plane misses it.
template <class T>
struct Disc {
    Vec<T> centre;
    Vec<T> normal;
    T outer_radius;
    T inner_radius;

    static constexpr std::string_view name = "disc", plural = "discs";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a disc of radius 2 in the plane z = -2",
                                      .touching_ray = "a ray through its rim",
                                      .degenerate = "an outer radius of 0",
                                      .anchor_points = "centres"};
    static constexpr std::array<Key, 4> keys{
        {{.name = "centre", .short_name = "c", .aliases = {"center"}},
         {.name = "normal", .short_name = "n", .kind = Key::Kind::direction, .limit = Key::Limit::not_zero},
         {.name = "outer_radius", .short_name = "ro", .kind = Key::Kind::length, .limit = Key::Limit::positive},
         {.name = "inner_radius",
          .short_name = "ri",
          .kind = Key::Kind::length,
          .limit = Key::Limit::non_negative_below_previous,
          .is_optional = true}}};

    /// Builds a disc of radius `half` in the plane z = p.z − half. A disc is flat, so it cannot extend that far on all
    /// sides.
    static Disc around(const Vec<T>& p, const T& half) {
        return {{p.x, p.y, p.z - half}, {T(0), T(0), T(1)}, half, T(0)};
    }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    [[nodiscard]] T half_extent() const { return outer_radius; }
    [[nodiscard]] Sphere<T> ball_around() const { return {centre, outer_radius}; }
    /// Returns the point at the fraction u.z of the distance from the inner rim to the outer, in the direction of u.x
    /// and u.y.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const PerpendicularAxes<T> axes(normal);
        const T x = 2 * u.x - 1, y = 2 * u.y - 1, size = sqrt(square(x) + square(y));
        const T r = inner_radius + u.z * (outer_radius - inner_radius);
        if (size == 0) return centre + r * axes.first;
        return centre + (r * x / size) * axes.first + (r * y / size) * axes.second;
    }
    [[nodiscard]] std::optional<Disc> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        if (length(Vec<T>(project_onto_plane(viewpoint) - centre)) == 0) return std::nullopt;
        const Vec<T> nearest_point = nearest(viewpoint);
        return Disc{nearest_point + factor * (centre - nearest_point), normal, factor * outer_radius,
                    factor * inner_radius};
    }

    /// With f = o − centre, n the normal and m = d·n, t = −(f·n)/m. The vector from the centre to that point, times m,
    /// is p = m f − (f·n) d = n × (f × d), which contains nothing of the size of f. So the test is inner² m² ≤ p² ≤
    /// outer² m². Every decision is the sign of a dyadic polynomial of degree six. For doubles, an interval of 6 (1024
    /// + 1074) + 8 < 12600 bits decides each.
    [[nodiscard]] FlatSpan<T> span(const Ray<T>& ray) const {
        const T zero(0);
        const Vec<T>& d = ray.direction;
        const Vec<T> f = ray.origin - centre;
        const T m = dot(d, normal), k = -dot(f, normal), m2 = square(m);
        const T p2 = square(cross(normal, cross(f, d))), outer = square(outer_radius) * m2;
        const T inner = square(inner_radius) * m2;
        const auto is_back = m > zero, is_front = m < zero, is_crossed = is_back || is_front,
                   is_full_disc = inner_radius <= zero;
        return {.at = {select(is_back, k, -k), select(is_back, m, -m)},
                .closed = is_crossed && p2 <= outer && (is_full_disc || p2 >= inner),
                .open = is_crossed && p2 < outer && (is_full_disc || p2 > inner),
                .is_front = is_front,
                .d2 = square(d)};
    }
    /// Returns the signed distance of a point from the plane, in units of `unit()`, positive on the side that the
    /// normal points to.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        return dot(p - centre, normal) / (length(normal) * outer_radius);
    }
    [[nodiscard]] T unit() const { return outer_radius; }
    /// Returns |p − q| with q the point of the disc nearest to p. A disc has no inside, so this is never negative.
    [[nodiscard]] T distance(const Vec<T>& p) const {
        const T radius_of_p = length(Vec<T>(project_onto_plane(p) - centre)),
                height = dot(p - centre, normal) / length(normal);
        return sqrt(square(max(max(inner_radius - radius_of_p, radius_of_p - outer_radius), T(0))) + square(height));
    }
    /// Returns the unit normal on the side that the ray comes from.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>&) const {
        const T size = length(normal);
        return (T(1) / (dot(normal, ray.direction) > T(0) ? -size : size)) * normal;
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_plane(p); }
    /// Returns the projected point p − (n·f/n²) n, f = p − centre, with its error bound: the subtracted term is off by
    /// γ(10)|f|, and f and the difference by one rounding each.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const T size = length(Vec<T>(p - centre));
        BoundedPoint<T> bounded{project_onto_plane(p), p};
        for (int i = 0; i < 3; ++i) bounded.delta[i] = gamma_bound<T>(12) * size + gamma_bound<T>(2) * abs(p[i]);
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> project_onto_plane(const Vec<T>& p) const {
        return p - (dot(p - centre, normal) / square(normal)) * normal;
    }
    [[nodiscard]] Vec<T> nearest(const Vec<T>& p) const {
        const Vec<T> w = project_onto_plane(p) - centre;
        const T distance_from_centre = length(w);
        return centre + (min(max(distance_from_centre, inner_radius), outer_radius) / distance_from_centre) * w;
    }
};

}  // namespace lostbits
