// Intersects a ray with three slabs in exact sums of any magnitude: the last step of `box.filtered`.
#pragma once

#include <array>
#include <cmath>

#include "number/wide/dyadic.hpp"

namespace lostbits::number::wide {

/// Indices of the inputs and the results of `meet_slabs`. Vectors take three numbers.
struct SlabIndex {
    static constexpr std::size_t origin = 0, direction = 3, first_plane = 6, second_plane = 9, ray_end = 12;
    static constexpr std::size_t decision = 0, tmin = 1, tmax = 2;
};

/// Computes the decision and t for doubles of any magnitude. `inputs` and `results` have the order of `SlabIndex`. The
/// decision is 1 for a hit and −1 for a miss.
template <class Tag>
[[gnu::noinline]] static void meet_slabs(const std::array<double, 13>& inputs, std::array<double, 3>& results) {
    using D = Dyadic<Tag>;
    D to_first[3], to_second[3], speed[3];  // the distances to the planes of an axis, times the sign of d, and |d|
    const double ray_end = inputs[SlabIndex::ray_end];
    bool is_hit = ray_end >= 0;
    results = {-1, 0, ray_end};
    for (std::size_t i = 0; i < 3; ++i) {
        const D origin(inputs[SlabIndex::origin + i]);
        const D first(inputs[SlabIndex::first_plane + i]), second(inputs[SlabIndex::second_plane + i]);
        const double direction = inputs[SlabIndex::direction + i];
        const bool is_reversed = std::signbit(direction);
        to_first[i] = is_reversed ? origin - first : first - origin;
        to_second[i] = is_reversed ? origin - second : second - origin;
        speed[i] = D(std::fabs(direction));

        // The slab must end at or after 0, and begin before the ray ends.
        const bool is_endless = std::isinf(ray_end) && speed[i].sign() > 0;
        is_hit = is_hit && to_second[i].sign() >= 0 &&
                 (is_endless || (D(std::isinf(ray_end) ? 0 : ray_end) * speed[i] - to_first[i]).sign() >= 0);

        if (speed[i].sign() == 0) continue;
        double &tmin = results[SlabIndex::tmin], &tmax = results[SlabIndex::tmax];
        tmin = std::fmax(tmin, (to_first[i].scaled() / speed[i].scaled()).value());
        tmax = std::fmin(tmax, (to_second[i].scaled() / speed[i].scaled()).value());
    }

    // Each slab must begin before the others end.
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            is_hit = is_hit && (i == j || (to_second[j] * speed[i] - to_first[i] * speed[j]).sign() >= 0);
    if (is_hit) results[SlabIndex::decision] = 1;
}

}  // namespace lostbits::number::wide
