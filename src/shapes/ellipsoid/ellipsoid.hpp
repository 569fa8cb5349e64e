// The ellipsoid: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "geometry/span.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points with (x/rx)² + (y/ry)² + (z/rz)² ≤ 1, with (x, y, z) relative to `centre`: a ball scaled along the axes.
template <class T>
struct Ellipsoid {
    Vec<T> centre;
    Vec<T> radii;

    static constexpr std::string_view name = "ellipsoid", plural = "ellipsoids";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "an ellipsoid of radii 2 around the origin",
                                      .touching_ray = "a ray that touches",
                                      .degenerate = "radii of 0",
                                      .anchor_points = "centres"};
    static constexpr std::array<Key, 2> keys{{{.name = "centre", .short_name = "c", .aliases = {"center"}},
                                              {.name = "radii",
                                               .short_name = "r",
                                               .kind = Key::Kind::lengths,
                                               .limit = Key::Limit::positive,
                                               .aliases = {"semiaxes"}}}};

    static Ellipsoid around(const Vec<T>& point, const T& half) { return {point, {half, half, half}}; }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    /// Half of the longest side of its bounding box.
    [[nodiscard]] T half_extent() const { return max(max(radii.x, radii.y), radii.z); }
    [[nodiscard]] Sphere<T> ball_around() const { return {centre, half_extent()}; }
    /// Returns the point at the fractions u of the sides of its bounding box.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const auto along = [](const T& c, const T& share, const T& r) { return c + (2 * share - 1) * r; };
        return {along(centre.x, u.x, radii.x), along(centre.y, u.y, radii.y), along(centre.z, u.z, radii.z)};
    }
    /// Returns the ellipsoid scaled by `factor`. Its surface point between the centre and `viewpoint` does not move.
    /// Returns nothing if `viewpoint` is the centre.
    [[nodiscard]] std::optional<Ellipsoid> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        const Vec<T> towards = viewpoint - centre;
        const T distance = length(divide_by_radii(towards));
        if (distance == 0) return std::nullopt;
        return Ellipsoid{centre - ((factor - 1) / distance) * towards, factor * radii};
    }

    /// With f = o − G, R = rx ry rz and s = R/r = (ry rz, rz rx, rx ry), in each component: h = (s f)·(s d),
    /// c = (s f)² − R², a = (s d)², and q = R² (a − (r (f × d))²), because (s f) × (s d) = R r (f × d). No step
    /// subtracts numbers of similar size, except exact differences of the inputs.
    [[nodiscard]] QuadraticSpan<T> span(const Ray<T>& ray) const {
        const Vec<T> f = ray.origin - centre;
        const Vec<T> s(radii.y * radii.z, radii.z * radii.x, radii.x * radii.y);
        const Vec<T> sf = s * f, sd = s * ray.direction, m = radii * cross(f, ray.direction);
        const T volume2 = square(T(radii.x * s.x)), a = square(sd);
        return {dot(sf, sd), square(sf) - volume2, a, volume2 * (a - square(m)), square(ray.direction)};
    }
    /// Returns a lower bound of the signed distance of a point from the surface, in units of `unit()`, positive
    /// outside: (|v/r|² − 1)/(|v/r| + 1) with v = p − G. Along the shortest radius this is the distance; elsewhere it
    /// is less.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        const Vec<T> v = divide_by_radii(p - centre);
        const T v2 = square(v);
        return (v2 - T(1)) / (sqrt(v2) + T(1));
    }
    /// The shortest radius.
    [[nodiscard]] T unit() const { return min(min(radii.x, radii.y), radii.z); }
    /// Returns a lower bound of the distance of a point from the surface, negative inside: (|v/r| − 1) min(r), because
    /// |v/r| grows by at most 1/min(r) per unit of length. The distance itself has no closed form.
    [[nodiscard]] T distance(const Vec<T>& p) const { return (length(divide_by_radii(p - centre)) - T(1)) * unit(); }
    /// Returns the outward unit normal at the point p of a ray, along v/r². Its components are multiplied by the
    /// shortest radius, so that none is larger than 1 on the surface.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> v = divide_by_radii(p - centre);
        const T least = unit();
        const Vec<T> n(v.x * (least / radii.x), v.y * (least / radii.y), v.z * (least / radii.z));
        const T size = length(n);
        return {n.x / size, n.y / size, n.z / size};
    }
    /// Moves the point of a ray onto the surface, along the line to the centre: G + v/|v/r|.
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> v = p - centre;
        const T k = T(1) / length(divide_by_radii(v));
        return {centre.x + k * v.x, centre.y + k * v.y, centre.z + k * v.z};
    }
    /// Returns the projected point with its error bound. |v/r| is off by γ(4) of itself (a quotient, a square and two
    /// sums, halved by the root, which rounds too), 1/|v/r| by γ(5), and each component v' of the product by γ(6)|v'|.
    /// In the world, the bound follows as for the sphere.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const Vec<T> v = p - centre;
        const T scale = T(1) / length(divide_by_radii(v));
        BoundedPoint<T> bounded{p, p};
        for (int i = 0; i < 3; ++i) {
            const T coordinate = v[i] * scale, size = abs(coordinate);
            bounded.p[i] = coordinate + centre[i];
            bounded.delta[i] =
                (gamma_bound<T>(3) + T(1)) * (gamma_bound<T>(6) * size) + gamma_bound<T>(3) * (size + abs(centre[i]));
        }
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> divide_by_radii(const Vec<T>& v) const {
        return {v.x / radii.x, v.y / radii.y, v.z / radii.z};
    }
};

}  // namespace lostbits
