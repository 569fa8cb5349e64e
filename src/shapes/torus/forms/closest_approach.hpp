// Computes by cross products from the point of the line nearest to the centre: a quartic in x = d² t + d·f without a
// cubic term. Of f, only the part across the line is squared. A resolvent cubic solves the quartic, and Newton's steps
// on the residual of the torus' own equation refine the roots.
#pragma once

#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct TorusFromClosest {
    static constexpr Info info{
        .name = "torus.closest_approach",
        .title = "quartic from the closest approach, polished",
        .source = "this project: see Torus::span",
        .roots = Roots::first_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const Vec<T> f = ray.origin - torus.centre, w = cross(f, ray.direction);
        const Vec<T> m = cross(torus.axis, cross(ray.direction, w)), k = cross(torus.axis, ray.direction);
        // The quartic x⁴ + p x² + q x + s.
        const T a = named("a", square(ray.direction)), b = named("b", dot(f, ray.direction)), n = square(torus.axis);
        const T R = torus.major_radius, r = torus.minor_radius, four_r2 = square(T(2) * R);
        const T e = named("e", a * ((R + r) * (R - r)) + square(w)), mk = dot(m, k), k2 = square(k);
        const T p = named("p", T(2) * e - four_r2 * k2 / n), q = named("q", T(-2) * (four_r2 * mk) / n);
        const T s = named("r", square(e) - four_r2 * square(m) / n);

        FirstHit<T> first_hit;
        take_depressed_roots<T>(p, q, s, [&](const auto& is_root, const T& first_x) {
            T x = first_x;
            for (int i = 0; i < 2; ++i) {
                const T inner = square(x) + e, slope = T(4) * (n * inner * x) - T(2) * (four_r2 * (mk + x * k2));
                const T residual = n * square(inner) - four_r2 * square(Vec<T>(m + x * k));
                x = select(abs(slope) > T(0), x - residual / slope, x);
            }
            first_hit.add_root(is_root, (x - b) / a);
        });
        return first_hit.answer();
    }
};

}  // namespace lostbits::intersect::torus
