// Decides by shortest distances: between line and axis for the side, and from each end to the line for its ball. The
// roots subtract no numbers of similar size.
#pragma once

#include "shapes/capsule/forms/parts.hpp"

namespace lostbits::intersect::capsule {

struct CapsulePerpendicular {
    static constexpr Info info{
        .name = "capsule.perpendicular",
        .title = "distances of the line from axis and ends, stable roots",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), eqs. 7-10, of side and balls",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Capsule<T>& capsule) {
        const Vec<T> v = capsule.end - capsule.start, f = ray.origin - capsule.start, &d = ray.direction;
        const Vec<T> n = cross(v, d), m = cross(v, f);
        const T v2 = square(v), r2 = square(capsule.radius), a = named("a", square(n)), d2 = square(d);
        const T disc = named("disc", v2 * (r2 * a - square(dot(f, n))));
        const PartRoots<T> side{
            disc < T(0), unified_roots<T>(a, named("h'", -dot(m, n)), named("c", square(m) - r2 * v2), sqrt(disc))};
        const auto solve_ball = [&](const Vec<T>& centre_to_origin) {
            const T minus_b = named("b'", -dot(centre_to_origin, d));
            const T delta = named("delta", r2 - square(Vec<T>(centre_to_origin + (minus_b / d2) * d)));
            const T c = named("c_ball", square(centre_to_origin) - r2);
            return PartRoots<T>{delta < T(0), unified_roots<T>(d2, minus_b, c, sqrt(d2 * delta))};
        };
        return choose_parts<T>(side, solve_ball(f), solve_ball(ray.origin - capsule.end), named("v.f", dot(v, f)),
                               named("v.d", dot(v, d)), v2);
    }
};

}  // namespace lostbits::intersect::capsule
