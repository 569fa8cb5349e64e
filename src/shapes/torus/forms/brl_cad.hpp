// Computes in units of the major radius, from the point of the line nearest to the centre. Polynomials are multiplied,
// and their products are subtracted coefficient by coefficient.
#pragma once

#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct BrlCad {
    static constexpr Info info{
        .name = "torus.brl_cad",
        .title = "unit torus, origin at the closest approach",
        .source = "BRL-CAD, src/librt/primitives/tor/tor_shot.cl, tor_shot (there with Laguerre's root finder)",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const TorusRay<T> relative(ray, torus);
        const T R = torus.major_radius, alpha = torus.minor_radius / R;
        const Vec<T> p = (T(1) / R) * relative.p;
        const T to_closest = named("cor_proj", dot(p, relative.d));
        const Vec<T> closest_point = p - to_closest * relative.d;
        const T z = relative.pz / R - to_closest * relative.dz, zz = square(z), zd = z * relative.dz,
                dd = square(relative.dz);
        const T x2 = square(relative.d) - dd, x1 = T(2) * (dot(relative.d, closest_point) - zd),
                x0 = square(closest_point) - zz;
        const T a2 = x2 + dd, a1 = x1 + T(2) * zd, a0 = x0 + zz + T(1) - square(alpha);
        const T c4 = square(a2), four(4);
        const Quartic<T> f{T(2) * (a2 * a1) / c4, (T(2) * (a2 * a0) + square(a1) - four * x2) / c4,
                           (T(2) * (a1 * a0) - four * x1) / c4, (square(a0) - four * x0) / c4};
        FirstHit<T> first_hit;
        take_quartic_roots<T>(
            f, [&](const auto& is_root, const T& k) { first_hit.add_root(is_root, (k - to_closest) * R); });
        return first_hit.answer();
    }
};

}  // namespace lostbits::intersect::torus
