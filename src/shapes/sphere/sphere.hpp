// The sphere.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding_bound.hpp"
#include "geometry/span.hpp"

namespace lostbits {

/// All points at distance `radius` > 0 from `centre`.
template <class T>
struct Sphere {
    Vec<T> centre;
    T radius;

    static constexpr std::string_view name = "sphere", plural = "spheres";
    static constexpr bool told_end = false, zero_inside = false, usually_unit = true, round = true, edges = false;
    static constexpr ShapeWords words{.plainest = "a sphere of radius 2 around the origin",
                                      .touching = "a ray that touches",
                                      .point = "a radius of 0",
                                      .places = "centres"};
    static constexpr std::array<Key, 2> keys{
        {{.name = "centre", .letter = "c", .aliases = {"center"}},
         {.name = "radius", .letter = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// One around a point, as far as this from it on each axis.
    static Sphere around(const Vec<T>& point, const T& half) { return {point, half}; }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    /// Half of the longest side of the box around it.
    [[nodiscard]] T half_extent() const { return radius; }
    /// The centre and the radius of a ball that holds it.
    [[nodiscard]] Sphere ball_around() const { return *this; }
    /// The point at these shares of the sides of the cube around it.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const auto along = [this](const T& c, const T& share) { return c + (2 * share - 1) * radius; };
        return {along(centre.x, u.x), along(centre.y, u.y), along(centre.z, u.z)};
    }
    /// k times as large, its point nearest to `still` where it was; nothing where no point is nearest.
    [[nodiscard]] std::optional<Sphere> grown(const Vec<T>& still, const T& k) const {
        const Vec<T> towards = still - centre;
        const T distance = length(towards);
        if (distance == 0) return std::nullopt;
        return Sphere{centre - ((k - 1) * radius / distance) * towards, k * radius};
    }

    /// With f = o − G: h = f·d, c = f·f − r², a = d·d, and q = a r² − |f × d|². No step subtracts numbers of like size
    /// that are not exact differences of the inputs.
    [[nodiscard]] QuadraticSpan<T> span(const Ray<T>& ray) const {
        const Vec<T> f = ray.origin - centre;
        const T r2 = square(radius), a = square(ray.direction);
        return {dot(f, ray.direction), square(f) - r2, a, a * r2 - square(cross(f, ray.direction)), a};
    }
    /// How far a point is outside, in units of `unit()`: (|v| − r)/r = (v·v − r²)/(r(|v| + r)) with v = p − G.
    [[nodiscard]] T off_surface(const Vec<T>& p) const {
        const Vec<T> v = p - centre;
        const T v2 = square(v);
        return (v2 - square(radius)) / (radius * (sqrt(v2) + radius));
    }
    [[nodiscard]] T unit() const { return radius; }
    /// How far a point is from the surface, negative inside: |p − G| − r.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(p - centre) - radius; }
    /// The outward unit normal at the point p of a ray: (p − G)/|p − G|.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>&, const Vec<T>& p) const { return unit_of(Vec<T>(p - centre)); }
    /// What pictures shade with: (p − G)/r, outward whichever side is seen, unit only as far as p lies on it.
    [[nodiscard]] Vec<T> shading_normal(const Vec<T>& p) const {
        return Vec<T>((p.x - centre.x) / radius, (p.y - centre.y) / radius, (p.z - centre.z) / radius);
    }
    /// The point of a ray put onto the surface: G + f (r/|f|) with f = p − G.
    [[nodiscard]] Vec<T> projected(const Ray<T>&, const Vec<T>& p) const {
        const Vec<T> f = p - centre;
        const T k = radius / length(f);
        return {centre.x + k * f.x, centre.y + k * f.y, centre.z + k * f.z};
    }
    /// The point of a ray at t put back onto it in object space, f' = f r/|f| with f = p − G, where each component is
    /// off by at most γ(5)|f'|; taken to the world, δ = (γ(3) + 1)γ(5)|f'| + γ(3)(|f'| + |G|).
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const Vec<T> f = p - centre;
        const T scale = radius / length(f);
        BoundedPoint<T> b{p, p};
        for (int i = 0; i < 3; ++i) {
            const T on = f[i] * scale, size = abs(on);
            b.p[i] = on + centre[i];
            b.delta[i] =
                (gamma_bound<T>(3) + T(1)) * (gamma_bound<T>(5) * size) + gamma_bound<T>(3) * (size + abs(centre[i]));
        }
        return b;
    }
};

}  // namespace lostbits
