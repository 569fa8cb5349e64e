// The vector from the centre to the hit point, times n·d, is n × (f × d), with f = o − centre. So no point far away is
// computed, and nothing is divided before the decision.
#pragma once

#include "shapes/disc/forms/parts.hpp"

namespace lostbits::intersect::disc {

struct MomentDisc {
    static constexpr Info info{
        .name = "disc.moment",
        .title = "n x (f x d) against the radius times n.d",
        .source = "this project: see Disc::span",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Disc<T>& disc) {
        const Vec<T> f = ray.origin - disc.centre, w = cross(f, ray.direction);
        const T m = named("n.d", dot(ray.direction, disc.normal)), m2 = square(m);
        const T p2 = named("p^2", square(cross(disc.normal, w))), t = named("t", -dot(f, disc.normal) / m);
        const auto is_inside = p2 <= square(disc.outer_radius) * m2 && p2 >= square(disc.inner_radius) * m2;
        return {is_inside && t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::disc
