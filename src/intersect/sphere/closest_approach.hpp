// Mitsuba 3: move the origin to the point of closest approach, t₀ = b'/a, O' = O + t₀d, solve the half-b quadratic with
// Press et al. roots from there, and add t₀ back.
#pragma once

#include "intersect/sphere/roots.hpp"

namespace lostbits::sphere {

struct ClosestApproach {
    static constexpr Info info{
        .name = "sphere.closest_approach",
        .title = "origin moved to the closest approach",
        .source = "Mitsuba 3, src/shapes/sphere.cpp",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", dot(ray.direction, ray.direction));
        const T t0 = named("t0", -dot(f, ray.direction) / a);
        const Vec<T> moved = ray.origin + t0 * ray.direction;
        const Vec<T> g = moved - sphere.centre;
        const T h = named("h", dot(g, ray.direction));
        const T c = named("c", dot(g, g) - sphere.radius * sphere.radius);
        const T disc = named("disc", h * h - a * c);
        const T root = sqrt(disc);
        // Without rounding h is 0 here, so no enclosure can ever tell its sign: both choices of q are carried to the
        // end, where they are the same two roots, and only then selected. Bit for bit what choosing q first gives.
        const mask_t<T> behind = -h < T(0);
        const T q_behind = named("q", -h - root);
        const T q_ahead = named("q", -h + root);
        const RootPair<T> roots{select(behind, q_behind / a, c / q_ahead), select(behind, c / q_behind, q_ahead / a)};
        return first_hit<T>(disc < T(0), RootPair<T>{t0 + roots.near, t0 + roots.far});
    }
};

}  // namespace lostbits::sphere
