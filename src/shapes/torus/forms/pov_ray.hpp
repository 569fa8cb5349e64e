// The origin is moved along the ray by as much as its distance exceeds R + 2r, so that the coefficients are of the size
// of the torus.
#pragma once

#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct PovRay {
    static constexpr Info info{
        .name = "torus.pov_ray",
        .title = "origin moved to the bounding sphere, quartic in t",
        .source = "POV-Ray, source/core/shape/torus.cpp, Torus::Intersect; solve_quartic of core/math/polynomialsolver",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const TorusRay<T> relative(ray, torus);
        const T distance = length(relative.p), bound = torus.major_radius + torus.minor_radius + torus.minor_radius;
        const T shift = named("closer", select(distance > bound, distance - bound, T(0)));
        const Vec<T> p = relative.p + shift * relative.d;
        FirstHit<T> first_hit;
        take_quartic_roots<T>(quartic_in_t<T>(p, relative.d, relative.pz + shift * relative.dz, relative.dz, torus),
                              [&](const auto& is_root, const T& t) { first_hit.add_root(is_root, t + shift); });
        return first_hit.answer();
    }
};

}  // namespace lostbits::intersect::torus
