// The axis-aligned box: its numbers, its exact span on a ray, and its distances.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "geometry/span.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

/// All points p with lo ≤ p ≤ hi in each component: closed, axis-aligned. A side may have zero thickness (lo = hi).
template <class T>
struct Box {
    Vec<T> lo;
    Vec<T> hi;

    static constexpr std::string_view name = "box", plural = "boxes";
    static constexpr bool takes_tmax = true, inside_returns_zero = true, usually_takes_unit_direction = false,
                          is_ball = false, has_edges = true;
    static constexpr ShapeTexts texts{.simplest = "a box from -2 to 2 in each component",
                                      .touching_ray = "a ray in the plane of a face",
                                      .degenerate = "a box that is a point",
                                      .anchor_points = "corners"};
    static constexpr std::array<Key, 2> keys{
        {{.name = "lo", .short_name = "lo"},
         {.name = "hi", .short_name = "hi", .limit = Key::Limit::at_least_previous}}};

    static Box around(const Vec<T>& point, const T& half) {
        return {{point.x - half, point.y - half, point.z - half}, {point.x + half, point.y + half, point.z + half}};
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * (lo + hi); }
    [[nodiscard]] T half_extent() const { return unit() / 2; }
    [[nodiscard]] Sphere<T> ball_around() const {
        const T half = T(1) / T(2);
        return {half * lo + half * hi, half * length(Vec<T>(hi - lo))};
    }
    /// Returns the point at the fractions u of the sides.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        return {lo.x + u.x * (hi.x - lo.x), lo.y + u.y * (hi.y - lo.y), lo.z + u.z * (hi.z - lo.z)};
    }
    [[nodiscard]] std::optional<Box> scaled_about_nearest(const Vec<T>& viewpoint, const T& factor) const {
        Box result;
        for (int i = 0; i < 3; ++i) {
            const T fixed_coordinate = min(max(viewpoint[i], lo[i]), hi[i]);
            result.lo[i] = fixed_coordinate + factor * (lo[i] - fixed_coordinate);
            result.hi[i] = fixed_coordinate + factor * (hi[i] - fixed_coordinate);
        }
        return result;
    }

    /// entry = (lo − o)/d and exit = (hi − o)/d where d > 0. They are swapped where d < 0. Both are scaled to a
    /// denominator of |d|.
    [[nodiscard]] SlabSpan<T> span(const Ray<T>& ray) const {
        const T zero(0), one(1);
        const mask_t<T> all_true = zero <= zero;
        SlabSpan<T> slabs{.entry = {},
                          .exit = {},
                          .crossed = {all_true, all_true, all_true},
                          .closed = all_true,
                          .open = all_true,
                          .d2 = square(ray.direction)};
        for_each_axis([&](auto i) {
            const T &o = ray.origin[i], &d = ray.direction[i];
            const T to_low = lo[i] - o, to_high = hi[i] - o;
            const auto is_forward = d > zero, is_crossed = is_forward || d < zero;
            const T m = select(is_forward, d, -d);
            slabs.entry[i] = {select(is_forward, to_low, -to_high), m};
            slabs.exit[i] = {select(is_forward, to_high, -to_low), m};
            slabs.open = slabs.open && lo[i] < hi[i];
            if (!any_of(!is_crossed)) return;
            slabs.entry[i] = select(is_crossed, slabs.entry[i], {-one, zero});
            slabs.exit[i] = select(is_crossed, slabs.exit[i], {one, zero});
            slabs.crossed[i] = is_crossed;
            slabs.closed = slabs.closed && (is_crossed || (to_low <= zero && to_high >= zero));
            slabs.open = slabs.open && (is_crossed || (to_low < zero && to_high > zero));
        });
        return slabs;
    }
    /// Returns the largest of lo − p and p − hi over the axes, in units of `unit()`. If it is positive, p lies outside
    /// by this much in its worst component; beside an edge or a corner this is less than the distance. If it is
    /// negative, p lies inside by this much from the nearest face.
    [[nodiscard]] T relative_distance(const Vec<T>& p) const {
        const auto distance_beyond = [&](int i) { return max(lo[i] - p[i], p[i] - hi[i]); };
        return max(max(distance_beyond(0), distance_beyond(1)), distance_beyond(2)) / unit();
    }
    /// The longest side.
    [[nodiscard]] T unit() const {
        const Vec<T> side = hi - lo;
        return max(max(side.x, side.y), side.z);
    }
    /// Returns the signed distance from p, |max(q, 0)| + min(max(q.x, max(q.y, q.z)), 0). In each component, q = max(lo
    /// − p, p − hi) is how far p lies beyond the nearer plane. The second term is zero outside, the first one inside.
    /// Source: SDF Sphere Marching (lesson P0-C1).
    [[nodiscard]] T distance(const Vec<T>& p) const {
        const T zero(0);
        const auto distance_beyond = [](const T& low, const T& high, const T& x) { return max(low - x, x - high); };
        const Vec<T> q(distance_beyond(lo.x, hi.x, p.x), distance_beyond(lo.y, hi.y, p.y),
                       distance_beyond(lo.z, hi.z, p.z));
        const T outside = length(Vec<T>(max(q.x, zero), max(q.y, zero), max(q.z, zero)));
        return outside + min(max(q.x, max(q.y, q.z)), zero);
    }
    /// Face that a ray hits: that of its latest entry or, from inside, of its earliest exit.
    struct Face {
        int axis = 0;
        bool is_high = false;
    };
    [[nodiscard]] Face hit_face(const Ray<T>& ray) const {
        Face entry_face, exit_face;
        bool crosses_any_slab = false;
        T latest_entry(0), earliest_exit(0);
        for (int i = 0; i < 3; ++i) {
            const bool is_forward = ray.direction[i] > T(0);
            if (!is_forward && !(ray.direction[i] < T(0))) continue;
            const T entry_t = ((is_forward ? lo[i] : hi[i]) - ray.origin[i]) / ray.direction[i];
            const T exit_t = ((is_forward ? hi[i] : lo[i]) - ray.origin[i]) / ray.direction[i];
            if (!crosses_any_slab || entry_t > latest_entry) latest_entry = entry_t, entry_face = {i, !is_forward};
            if (!crosses_any_slab || exit_t < earliest_exit) earliest_exit = exit_t, exit_face = {i, is_forward};
            crosses_any_slab = true;
        }
        return latest_entry > T(0) ? entry_face : exit_face;
    }
    /// Returns the outward unit normal of the face that the ray hits.
    [[nodiscard]] Vec<T> outward_normal(const Ray<T>& ray, const Vec<T>&) const {
        const Face face = hit_face(ray);
        Vec<T> n(T(0), T(0), T(0));
        n[face.axis] = face.is_high ? T(1) : T(-1);
        return n;
    }
    /// Moves the hit point of a ray onto the surface: the coordinate of the face replaces the computed one.
    [[nodiscard]] Vec<T> project_onto_surface(const Ray<T>& ray, const Vec<T>& p) const {
        const Face face = hit_face(ray);
        Vec<T> surface_point = p;
        surface_point[face.axis] = face.is_high ? hi[face.axis] : lo[face.axis];
        return surface_point;
    }
    /// The hit is at t = (plane − o)·(1/d), whose error is at most γ(3)|t|. Each component of p = o + t·d is off by at
    /// most δ = (γ(3) + 1)γ(3)|t d| + γ(3)|t d| + u|o + t d|.
    [[nodiscard]] BoundedPoint<T> bounded_point(const Ray<T>& ray, const T& t, const Vec<T>& p) const {
        BoundedPoint<T> bounded{p, p};
        for (int i = 0; i < 3; ++i) {
            const T step = abs(t * ray.direction[i]);
            bounded.delta[i] = (gamma_bound<T>(3) + T(1)) * (gamma_bound<T>(3) * step) + gamma_bound<T>(3) * step +
                               unit_roundoff<T>() * abs(p[i]);
        }
        return bounded;
    }
};

}  // namespace lostbits
