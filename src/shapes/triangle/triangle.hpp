// The triangle.
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

/// All points u a + v b + w c with u, v, w ≥ 0 and u + v + w = 1: closed, seen from both sides, with an area. A line in
/// its plane misses it: the points that they share are a segment with no first t of its own, and no code answers one.
template <class T>
struct Triangle {
    Vec<T> a;
    Vec<T> b;
    Vec<T> c;

    static constexpr std::string_view name = "triangle", plural = "triangles";
    static constexpr bool told_end = false, zero_inside = false, usually_unit = false, round = false, edges = false;
    static constexpr ShapeWords words{.plainest = "a triangle in the plane z = -2, from -2 to 2 in x and y",
                                      .touching = "a ray through an edge",
                                      .point = "a triangle without area",
                                      .places = "vertices"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "a", .letter = "v0", .aliases = {"v0", "p0"}},
         {.name = "b", .letter = "v1", .aliases = {"v1", "p1"}},
         {.name = "c", .letter = "v2", .limit = Key::Limit::off_line_before, .aliases = {"v2", "p2"}}}};

    /// Across the z axis of the point, below it by `half`: flat, it cannot reach that far on all sides.
    static Triangle around(const Vec<T>& p, const T& half) {
        return {
            {p.x - half, p.y - half, p.z - half}, {p.x + half, p.y - half, p.z - half}, {p.x, p.y + half, p.z - half}};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(3)) * (a + b + c); }
    /// Half of the longest side of the box around it.
    [[nodiscard]] T half_extent() const { return unit() / 2; }
    [[nodiscard]] Sphere<T> ball_around() const {
        const Vec<T> m = middle();
        const T reach = max(max(square(Vec<T>(a - m)), square(Vec<T>(b - m))), square(Vec<T>(c - m)));
        return {m, sqrt(reach)};
    }
    /// u.x and u.y of the way along two sides, folded back where that leads out: evenly over the triangle.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const bool out = u.x + u.y > 1;
        return a + (out ? 1 - u.x : u.x) * (b - a) + (out ? 1 - u.y : u.y) * (c - a);
    }
    [[nodiscard]] std::optional<Triangle> grown(const Vec<T>& still, const T& k) const {
        const Vec<T> there = nearest(still);
        return Triangle{there + k * (a - there), there + k * (b - there), there + k * (c - there)};
    }

    /// With a, b, c as seen from o, the line passes the edges on the sides that the signs of d·(b × c), d·(c × a) and
    /// d·(a × b) say; they add up to d·n, n = (b − a) × (c − a), and it crosses where none has another sign than that.
    /// t = a·n/(d·n): n from the vertices and not from o, so that nothing cancels however far away o is. Source: signed
    /// volumes, Segura and Feito, Algorithms to test ray-triangle intersection, 2001. All are dyadic polynomials of
    /// degree three, t one over the other: for doubles an interval of 3 (1024 + 1074) + 6 < 6400 bits decides each.
    [[nodiscard]] FlatSpan<T> span(const Ray<T>& ray) const {
        const T zero(0);
        const Vec<T> e = volumes(ray), n = normal();
        const T m = dot(ray.direction, n), k = dot(Vec<T>(a - ray.origin), n);
        const auto back = m > zero, front = m < zero;
        return {.at = {select(back, k, -k), select(back, m, -m)},
                .closed = (back && e.x >= zero && e.y >= zero && e.z >= zero) ||
                          (front && e.x <= zero && e.y <= zero && e.z <= zero),
                .open = (back && e.x > zero && e.y > zero && e.z > zero) ||
                        (front && e.x < zero && e.y < zero && e.z < zero),
                .front = front,
                .d2 = square(ray.direction)};
    }
    /// The barycentric coordinates of where the line crosses the plane, x a + y b + z c: of the three numbers whose
    /// signs tell on which sides of the edges it passes, each over their sum d·n.
    [[nodiscard]] Vec<T> weights(const Ray<T>& ray) const {
        return (T(1) / dot(ray.direction, normal())) * volumes(ray);
    }
    /// How far a point is from the plane, in units of `unit()`, on the side that n points to.
    [[nodiscard]] T off_surface(const Vec<T>& p) const {
        const Vec<T> n = normal();
        return dot(p - a, n) / (length(n) * unit());
    }
    /// The longest side of the box around it.
    [[nodiscard]] T unit() const {
        const auto side = [](const T& x, const T& y, const T& z) { return max(max(x, y), z) - min(min(x, y), z); };
        return max(max(side(a.x, b.x, c.x), side(a.y, b.y, c.y)), side(a.z, b.z, c.z));
    }
    /// |p − q|, q the point of the triangle nearest to p. It has no inside, so this is never negative.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - nearest(p))); }
    /// The unit normal on the side that the ray comes from.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>&) const {
        const Vec<T> n = normal();
        const T size = length(n);
        return (T(1) / (dot(n, ray.direction) > T(0) ? -size : size)) * n;
    }
    [[nodiscard]] Vec<T> projected(const Ray<T>&, const Vec<T>& p) const { return onto_plane(p); }
    /// u a + v b + w c by the barycentric coordinates of p, each component off by at most γ(7)(|u a| + |v b| + |w c|).
    /// Source: pbrt-v4, section 6.8.4.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>&, const T&, const Vec<T>& p) const {
        const Vec<T> n = normal(), from = p - a;
        const T n2 = square(n);
        const T v = dot(cross(from, c - a), n) / n2, w = dot(cross(b - a, from), n) / n2, u = T(1) - v - w;
        BoundedPoint<T> bounded{p, p};
        for (int i = 0; i < 3; ++i) {
            bounded.p[i] = u * a[i] + v * b[i] + w * c[i];
            bounded.delta[i] = gamma_bound<T>(7) * (abs(u * a[i]) + abs(v * b[i]) + abs(w * c[i]));
        }
        return bounded;
    }

private:
    [[nodiscard]] Vec<T> normal() const { return cross(b - a, c - a); }
    /// d·(b × c), d·(c × a) and d·(a × b), the vertices as seen from o.
    [[nodiscard]] Vec<T> volumes(const Ray<T>& ray) const {
        const Vec<T> pa = a - ray.origin, pb = b - ray.origin, pc = c - ray.origin;
        return Vec<T>(dot(ray.direction, cross(pb, pc)), dot(ray.direction, cross(pc, pa)),
                      dot(ray.direction, cross(pa, pb)));
    }
    [[nodiscard]] Vec<T> onto_plane(const Vec<T>& p) const {
        const Vec<T> n = normal();
        return p - (dot(p - a, n) / square(n)) * n;
    }
    /// The point of the segment from x to y that is nearest to p.
    static Vec<T> on_edge(const Vec<T>& x, const Vec<T>& y, const Vec<T>& p) {
        const Vec<T> along = y - x;
        return x + min(max(dot(p - x, along) / square(along), T(0)), T(1)) * along;
    }
    /// That of the plane where p lies over or under the triangle, else the nearest of the edges' points.
    [[nodiscard]] Vec<T> nearest(const Vec<T>& p) const {
        const T zero(0);
        const Vec<T> n = normal();
        const auto within = [&](const Vec<T>& x, const Vec<T>& y) { return dot(cross(n, y - x), p - x) >= zero; };
        const auto over = within(a, b) && within(b, c) && within(c, a);
        const auto chosen = [](const mask_t<T>& mask, const Vec<T>& x, const Vec<T>& y) {
            return Vec<T>(select(mask, x.x, y.x), select(mask, x.y, y.y), select(mask, x.z, y.z));
        };
        const auto nearer = [&](const Vec<T>& x, const Vec<T>& y) {
            return chosen(square(Vec<T>(x - p)) < square(Vec<T>(y - p)), x, y);
        };
        return chosen(over, onto_plane(p), nearer(nearer(on_edge(a, b, p), on_edge(b, c, p)), on_edge(c, a, p)));
    }
};

}  // namespace lostbits
