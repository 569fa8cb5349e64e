// Intersects a ray with a sphere in exact sums of any magnitude: the last step of `sphere.filtered`.
#pragma once

#include <array>

#include "number/wide/dyadic.hpp"

namespace lostbits::number::wide {

/// Computes the decision and t for doubles of any magnitude: with f = origin − centre, h = f·d, c = f·f − r² and a =
/// d·d, the discriminant is h² − ac. `in` holds origin, direction, centre and radius. `out` receives 1 for a hit or −1
/// for a miss, then t or −1.
template <class Tag>
[[gnu::noinline]] static void meet_sphere(const std::array<double, 10>& in, std::array<double, 2>& out) {
    using D = Dyadic<Tag>;
    const D r(in[9]);
    D h, a, c = -(r * r);
    for (std::size_t i = 0; i < 3; ++i) {
        const D f = D(in[i]) - D(in[6 + i]), d(in[3 + i]);
        h = h + f * d;
        a = a + d * d;
        c = c + f * f;
    }

    // A ray on the surface hits at 0. A ray outside that moves away misses.
    out = {-1, -1};
    if (c.sign() == 0) out = {1, 0};
    if (c.sign() == 0 || a.sign() == 0 || (c.sign() > 0 && h.sign() >= 0)) return;

    const D disc = h * h - a * c;
    if (disc.sign() < 0) return;
    out[0] = 1;
    const ScaledDouble<Tag> q = abs(h.scaled()) + sqrt(disc.scaled());
    out[1] = (c.sign() < 0 && h.sign() <= 0 ? q / a.scaled() : abs(c.scaled()) / q).value();
}

}  // namespace lostbits::number::wide
