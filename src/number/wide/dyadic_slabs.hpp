// Intersects a ray with three slabs in exact sums of any magnitude: the last step of `box.filtered`.
#pragma once

#include <array>
#include <cmath>

#include "number/wide/dyadic.hpp"

namespace lostbits::number::wide {

/// Computes the decision and t for doubles of any magnitude. On each axis, m = |d|, and n and f are the distances to
/// the first and the second plane, times the sign of d. `in` holds origin, direction, first and second planes, and the
/// end of the ray. `out` receives 1 for a hit or −1 for a miss, then tmin and tmax.
template <class Tag>
[[gnu::noinline]] static void meet_slabs(const std::array<double, 13>& in, std::array<double, 3>& out) {
    using D = Dyadic<Tag>;
    D n[3], f[3], m[3];
    const double ray_end = in[12];
    bool is_hit = ray_end >= 0;
    out = {-1, 0, ray_end};
    for (std::size_t i = 0; i < 3; ++i) {
        const D o(in[i]);
        const bool is_reversed = std::signbit(in[3 + i]);
        n[i] = is_reversed ? o - D(in[6 + i]) : D(in[6 + i]) - o;
        f[i] = is_reversed ? o - D(in[9 + i]) : D(in[9 + i]) - o;
        m[i] = D(std::fabs(in[3 + i]));

        // The slab must end at or after 0, and begin before the ray ends.
        const bool is_endless = std::isinf(ray_end) && m[i].sign() > 0;
        is_hit = is_hit && f[i].sign() >= 0 &&
                 (is_endless || (D(std::isinf(ray_end) ? 0 : ray_end) * m[i] - n[i]).sign() >= 0);

        if (m[i].sign() == 0) continue;
        out[1] = std::fmax(out[1], (n[i].scaled() / m[i].scaled()).value());
        out[2] = std::fmin(out[2], (f[i].scaled() / m[i].scaled()).value());
    }

    // Each slab must begin before the others end.
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) is_hit = is_hit && (i == j || (f[j] * m[i] - n[i] * m[j]).sign() >= 0);
    if (is_hit) out[0] = 1;
}

}  // namespace lostbits::number::wide
