// The sphere: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "geometry/span.hpp"

namespace lostbits {

/// All points at distance `radius` > 0 from `centre`. In formulas, G is the centre and r the radius.
template <class T>
struct Sphere {
    Vec<T> centre;
    T radius;

    static constexpr std::string_view name = "sphere", plural = "spheres";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = true,
                          is_ball = true, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a sphere of radius 2 around the origin",
                                      .touching_ray = "a ray that touches",
                                      .degenerate = "a radius of 0",
                                      .anchor_points = "centres"};
    static constexpr std::array<Key, 2> keys{
        {{.name = "centre", .short_name = "c", .aliases = {"center"}},
         {.name = "radius", .short_name = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// Builds a sphere around a point. It extends `half` from the point on each axis.
    static Sphere around(const Vec<T>& point, const T& half) { return {point, half}; }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    /// Returns half of the longest side of the bounding box.
    [[nodiscard]] T half_extent() const { return radius; }
    /// Returns centre and radius of a ball that holds the sphere.
    [[nodiscard]] Sphere ball_around() const { return *this; }
    /// Returns the point at the fractions u of the sides of its bounding cube.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const auto along = [this](const T& c, const T& share) { return c + (2 * share - 1) * radius; };
        return {along(centre.x, u.x), along(centre.y, u.y), along(centre.z, u.z)};
    }
    /// Returns the sphere scaled by `factor`. Its surface point nearest to `viewpoint` does not move. Returns nothing
    /// if there is no single nearest point.
    [[nodiscard]] std::optional<Sphere> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        const Vec<T> towards = viewpoint - centre;
        const T distance = length(towards);
        if (distance == 0) return std::nullopt;
        return Sphere{centre - ((factor - 1) * radius / distance) * towards, factor * radius};
    }

    /// With f = o − G: h = f·d, c = f·f − r², a = d·d, and q = a r² − |f × d|². No step subtracts numbers of similar
    /// size, except exact differences of the inputs.
    [[nodiscard]] QuadraticSpan<T> span(const Ray<T>& ray) const {
        const Vec<T> f = ray.origin - centre;
        const T r2 = square(radius), a = square(ray.direction);
        return {dot(f, ray.direction), square(f) - r2, a, a * r2 - square(cross(f, ray.direction)), a};
    }
    /// Returns the signed distance of a point from the surface, in units of `unit()`, positive outside: (|v| − r)/r =
    /// (v·v − r²)/(r(|v| + r)) with v = p − G.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        const Vec<T> v = p - centre;
        const T v2 = square(v);
        return (v2 - square(radius)) / (radius * (sqrt(v2) + radius));
    }
    [[nodiscard]] T unit() const { return radius; }
    /// Returns the signed distance of a point from the surface, negative inside: |p − G| − r.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(p - centre) - radius; }
    /// Returns the outward unit normal at the point p of a ray: (p − G)/|p − G|.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const { return unit_of(Vec<T>(p - centre)); }
    /// Returns the normal that pictures shade with: (p − G)/r, outward on both sides. It has unit length only if p is
    /// exactly on the surface.
    [[nodiscard]] Vec<T> shading_normal(const Vec<T>& p) const {
        return Vec<T>((p.x - centre.x) / radius, (p.y - centre.y) / radius, (p.z - centre.z) / radius);
    }
    /// Moves the point of a ray onto the surface: G + f (r/|f|) with f = p − G.
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> f = p - centre;
        const T k = radius / length(f);
        return {centre.x + k * f.x, centre.y + k * f.y, centre.z + k * f.z};
    }
    /// Returns the projected point with its error bound. In object space it is f' = f r/|f| with f = p − G, each
    /// component off by at most γ(5)|f'|. In the world, the bound is δ = (γ(3) + 1)γ(5)|f'| + γ(3)(|f'| + |G|).
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const Vec<T> f = p - centre;
        const T scale = radius / length(f);
        BoundedPoint<T> bounded{p, p};
        for (int i = 0; i < 3; ++i) {
            const T coordinate = f[i] * scale, size = abs(coordinate);
            bounded.p[i] = coordinate + centre[i];
            bounded.delta[i] =
                (gamma_bound<T>(3) + T(1)) * (gamma_bound<T>(5) * size) + gamma_bound<T>(3) * (size + abs(centre[i]));
        }
        return bounded;
    }
};

}  // namespace lostbits
