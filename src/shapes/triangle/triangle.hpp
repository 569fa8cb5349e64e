// The triangle: its numbers, its exact span on a ray, and its distances.
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

/// All points u a + v b + w c with u, v, w ≥ 0 and u + v + w = 1. The triangle is closed and has an area, and a ray may
/// hit it from both sides. A line in its plane misses it: no known code reports the segment that they share.
template <class T>
struct Triangle {
    Vec<T> a;
    Vec<T> b;
    Vec<T> c;

    static constexpr std::string_view name = "triangle", plural = "triangles";
    static constexpr bool takes_tmax = false, inside_returns_zero = false, usually_takes_unit_direction = false,
                          is_ball = false, has_edges = false;
    static constexpr ShapeTexts texts{.simplest = "a triangle in the plane z = -2, from -2 to 2 in x and y",
                                      .touching_ray = "a ray through an edge",
                                      .degenerate = "a triangle without area",
                                      .anchor_points = "vertices"};
    static constexpr std::array<Key, 3> keys{
        {{.name = "a", .short_name = "v0", .aliases = {"v0", "p0"}},
         {.name = "b", .short_name = "v1", .aliases = {"v1", "p1"}},
         {.name = "c", .short_name = "v2", .limit = Key::Limit::not_collinear_with_previous, .aliases = {"v2", "p2"}}}};

    /// Builds a triangle in the plane z = p.z − half, from p − half to p + half in x and y. A triangle is flat, so it
    /// cannot extend that far on all sides.
    static Triangle around(const Vec<T>& p, const T& half) {
        return {
            {p.x - half, p.y - half, p.z - half}, {p.x + half, p.y - half, p.z - half}, {p.x, p.y + half, p.z - half}};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(3)) * (a + b + c); }
    /// Half of the longest side of its bounding box.
    [[nodiscard]] T half_extent() const { return unit() / 2; }
    [[nodiscard]] Sphere<T> ball_around() const {
        const Vec<T> m = middle();
        const T radius2 = max(max(square(Vec<T>(a - m)), square(Vec<T>(b - m))), square(Vec<T>(c - m)));
        return {m, sqrt(radius2)};
    }
    /// Returns the point at the fractions u.x and u.y along two sides, mirrored back if it would be outside. For
    /// uniform u, the points are uniform over the triangle.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const bool is_outside = u.x + u.y > 1;
        return a + (is_outside ? 1 - u.x : u.x) * (b - a) + (is_outside ? 1 - u.y : u.y) * (c - a);
    }
    [[nodiscard]] std::optional<Triangle> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        const Vec<T> nearest_point = nearest(viewpoint);
        return Triangle{nearest_point + factor * (a - nearest_point), nearest_point + factor * (b - nearest_point),
                        nearest_point + factor * (c - nearest_point)};
    }

    /// With a, b, c relative to o, the signs of d·(b × c), d·(c × a) and d·(a × b) say on which sides the line passes
    /// the edges. They add up to d·n, n = (b − a) × (c − a), and the line crosses the triangle if none has the opposite
    /// sign. t = a·n/(d·n). n is computed from the vertices and not from o, so nothing cancels however far away o is.
    /// Source: signed volumes, Segura and Feito, Algorithms to test ray-triangle intersection, 2001. Every decision is
    /// the sign of a dyadic polynomial of degree three, and t is a quotient of two. For doubles, an interval of 3 (1024
    /// + 1074) + 6 < 6400 bits decides each.
    [[nodiscard]] FlatSpan<T> span(const Ray<T>& ray) const {
        const T zero(0);
        const Vec<T> e = volumes(ray), n = normal();
        const T m = dot(ray.direction, n), k = dot(Vec<T>(a - ray.origin), n);
        const auto is_back = m > zero, is_front = m < zero;
        return {.at = {select(is_back, k, -k), select(is_back, m, -m)},
                .closed = (is_back && e.x >= zero && e.y >= zero && e.z >= zero) ||
                          (is_front && e.x <= zero && e.y <= zero && e.z <= zero),
                .open = (is_back && e.x > zero && e.y > zero && e.z > zero) ||
                        (is_front && e.x < zero && e.y < zero && e.z < zero),
                .is_front = is_front,
                .d2 = square(ray.direction)};
    }
    /// Returns the barycentric coordinates (x, y, z) of the point x a + y b + z c at which the line crosses the plane:
    /// the three numbers of `span` whose signs say on which sides of the edges the line passes, divided by their sum
    /// d·n.
    [[nodiscard]] Vec<T> barycentric_coordinates(const Ray<T>& ray) const {
        return (T(1) / dot(ray.direction, normal())) * volumes(ray);
    }
    /// Returns the signed distance of a point from the plane, in units of `unit()`, positive on the side that n points
    /// to.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        const Vec<T> n = normal();
        return dot(p - a, n) / (length(n) * unit());
    }
    /// The longest side of its bounding box.
    [[nodiscard]] T unit() const {
        const auto extent = [](const T& x, const T& y, const T& z) { return max(max(x, y), z) - min(min(x, y), z); };
        return max(max(extent(a.x, b.x, c.x), extent(a.y, b.y, c.y)), extent(a.z, b.z, c.z));
    }
    /// Returns |p − q| with q the point of the triangle nearest to p. A triangle has no inside, so this is never
    /// negative.
    [[nodiscard]] T distance(const Vec<T>& p) const { return length(Vec<T>(p - nearest(p))); }
    /// The unit normal on the side that the ray comes from.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>&) const {
        const Vec<T> n = normal();
        const T size = length(n);
        return (T(1) / (dot(n, ray.direction) > T(0) ? -size : size)) * n;
    }
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>&, const Vec<T>& p) const { return project_onto_plane(p); }
    /// Returns the projected point u a + v b + w c, by the barycentric coordinates of p, with its error bound: each
    /// component is off by at most γ(7)(|u a| + |v b| + |w c|). Source: pbrt-v4, section 6.8.4.
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
    /// Returns d·(b × c), d·(c × a) and d·(a × b), with the vertices relative to o.
    [[nodiscard]] Vec<T> volumes(const Ray<T>& ray) const {
        const Vec<T> pa = a - ray.origin, pb = b - ray.origin, pc = c - ray.origin;
        return Vec<T>(dot(ray.direction, cross(pb, pc)), dot(ray.direction, cross(pc, pa)),
                      dot(ray.direction, cross(pa, pb)));
    }
    [[nodiscard]] Vec<T> project_onto_plane(const Vec<T>& p) const {
        const Vec<T> n = normal();
        return p - (dot(p - a, n) / square(n)) * n;
    }
    /// Returns the point of the segment from x to y that is nearest to p.
    static Vec<T> nearest_on_edge(const Vec<T>& x, const Vec<T>& y, const Vec<T>& p) {
        const Vec<T> edge = y - x;
        return x + min(max(dot(p - x, edge) / square(edge), T(0)), T(1)) * edge;
    }
    /// Returns the point of the triangle nearest to p: its projection onto the plane if this lies in the triangle, else
    /// the nearest point of an edge.
    [[nodiscard]] Vec<T> nearest(const Vec<T>& p) const {
        const T zero(0);
        const Vec<T> n = normal();
        const auto is_inside_edge = [&](const Vec<T>& x, const Vec<T>& y) {
            return dot(cross(n, y - x), p - x) >= zero;
        };
        const auto is_over = is_inside_edge(a, b) && is_inside_edge(b, c) && is_inside_edge(c, a);
        const auto select_vec = [](const mask_t<T>& mask, const Vec<T>& x, const Vec<T>& y) {
            return Vec<T>(select(mask, x.x, y.x), select(mask, x.y, y.y), select(mask, x.z, y.z));
        };
        const auto nearer = [&](const Vec<T>& x, const Vec<T>& y) {
            return select_vec(square(Vec<T>(x - p)) < square(Vec<T>(y - p)), x, y);
        };
        return select_vec(is_over, project_onto_plane(p),
                          nearer(nearer(nearest_on_edge(a, b, p), nearest_on_edge(b, c, p)), nearest_on_edge(c, a, p)));
    }
};

}  // namespace lostbits
