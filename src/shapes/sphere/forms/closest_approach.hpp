// After Mitsuba 3: move the origin to the point of closest approach, t₀ = b'/a, O' = O + t₀d, solve the half-b
// quadratic with Press et al. roots from there, and add t₀ back. There are three differences. Mitsuba divides by |d|
// where this form divides by a = d·d (its directions have unit length; for any other its O' is not the closest point).
// It keeps the factor 2 in b. On the CPU it computes everything in double, except t₀ and O', which pass through float;
// this form computes in the format of its input.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct ClosestApproach {
    static constexpr Info info{
        .name = "sphere.closest_approach",
        .title = "origin moved to the closest approach",
        .source = "after Mitsuba 3, src/shapes/sphere.cpp",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T t0 = named("t0", -dot(f, ray.direction) / a);
        const Vec<T> moved_origin = ray.origin + t0 * ray.direction;
        const Vec<T> g = moved_origin - sphere.centre;
        const T h = named("h", dot(g, ray.direction));
        const T c = named("c", square(g) - square(sphere.radius));
        const T disc = named("disc", square(h) - a * c);
        const RootPair<T> roots = unified_roots<T>(a, -h, c, sqrt(disc));
        return hit_unless<T>(disc < T(0), RootPair<T>{t0 + roots.near, t0 + roots.far});
    }
};

}  // namespace lostbits::intersect::sphere
