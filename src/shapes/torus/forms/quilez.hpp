// Quilez: half coefficients, absolute thresholds, and the polynomial in 1/t if the cubic and the linear term nearly
// satisfy a condition (`is_reciprocal`).
#pragma once

#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct QuilezTorus {
    static constexpr Info info{
        .name = "torus.quilez",
        .title = "half coefficients, 1/t if these nearly fit",
        .source = "Quilez, Intersectors, torIntersect",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    static constexpr bool has_loops = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const TorusRay<T> relative(ray, torus);
        const T zero(0), one(1), two(2), three(3), four(4);
        const T Ra2 = square(torus.major_radius), ra2 = square(torus.minor_radius);
        const T m = square(relative.p), n = dot(relative.p, relative.d), k = named("k", (m - ra2 - Ra2) / two);
        const T a3 = n, a2 = named("k2", square(n) + Ra2 * square(relative.dz) + k);
        const T a1 = named("k1", k * n + Ra2 * (relative.pz * relative.dz));
        const T a0 = named("k0", square(k) + Ra2 * square(relative.pz) - Ra2 * ra2);

        // Solves for 1/t instead where c1 would be close to 0.
        const auto is_reciprocal = abs(a3 * (square(a3) - a2) + a1) < one / T(100);
        const T k0 = select(is_reciprocal, one / a0, a0), k1 = select(is_reciprocal, a3 * k0, a1);
        const T k2 = select(is_reciprocal, a2 * k0, a2), k3 = select(is_reciprocal, a1 * k0, a3);

        const T c2 = named("c2", (two * k2 - three * square(k3)) / three);
        const T c1 = named("c1", two * (k3 * (square(k3) - k2) + k1));
        const T c0 = named("c0", (k3 * (k3 * (four * k2 - three * square(k3)) - T(8) * k1) + four * k0) / three);

        // z³ − 3Q z − 2R = 0: two cube roots, or a cosine if there are three real roots.
        const T Q = square(c2) + c0, R = three * c0 * c2 - c2 * square(c2) - square(c1);
        const T s = sqrt(three * abs(Q)), upper_end = s + two * abs(R) / square(s);
        const T root =
            select(R < zero, -one, one) * cubic_root_between<T>(zero, upper_end, zero, -three * Q, -two * abs(R));
        const T z = named("z", c2 - root), d1 = z - three * c2, d2 = square(z) - three * c0;
        const auto is_small = abs(d1) < one / T(10000),
                   has_no_root = (is_small && d2 < zero) || (!is_small && d1 < zero);
        const T e1 = select(is_small, d1, sqrt(d1 / two)), e2 = select(is_small, sqrt(d2), c1 / e1);

        FirstHit<T> first_hit;
        const auto add_pair = [&](const T& h, const T& centre) {
            const auto is_real = h > zero && !has_no_root;
            for (const T& t : {centre - sqrt(h) - k3, centre + sqrt(h) - k3}) {
                const T t_in_ray = select(is_reciprocal, two / t, t);
                first_hit.add_root(is_real && t_in_ray > zero, t_in_ray);
            }
        };
        add_pair(square(e1) - z + e2, -e1);
        add_pair(square(e1) - z - e2, e1);
        return first_hit.answer();
    }
};

}  // namespace lostbits::intersect::torus
