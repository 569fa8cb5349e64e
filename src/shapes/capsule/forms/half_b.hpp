// Roots by the quadratic with half b, for the side, from cross products with the axis, and for both balls.
#pragma once

#include "shapes/capsule/forms/parts.hpp"

namespace lostbits::intersect::capsule {

struct CapsuleHalfB {
    static constexpr Info info{
        .name = "capsule.half_b",
        .title = "cross products with the axis, half b of side and balls",
        .source = "Ericson, Real-Time Collision Detection (2005), section 5.3.7, of spheres swept along a segment",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Capsule<T>& capsule) {
        const Vec<T> v = capsule.end - capsule.start, f = ray.origin - capsule.start, &d = ray.direction;
        const Vec<T> n = cross(v, d), m = cross(v, f);
        const T v2 = square(v), r2 = square(capsule.radius);
        const auto solve = [](const T& a, const T& h, const T& c) {
            const T disc = named("disc", square(h) - a * c);
            return PartRoots<T>{disc < T(0), plain_half_roots<T>(a, h, sqrt(disc))};
        };
        const auto solve_ball = [&](const Vec<T>& centre_to_origin) {
            return solve(square(d), named("h_ball", dot(centre_to_origin, d)),
                         named("c_ball", square(centre_to_origin) - r2));
        };
        const PartRoots<T> side = solve(named("a", square(n)), named("h", dot(m, n)), named("c", square(m) - r2 * v2));
        return choose_parts<T>(side, solve_ball(f), solve_ball(ray.origin - capsule.end), named("v.f", dot(v, f)),
                               named("v.d", dot(v, d)), v2);
    }
};

}  // namespace lostbits::intersect::capsule
