// Boxes and rays for the packed kernels, seeded: what boxes are hit by, and every special number.
#pragma once

#include "intersect/simd/packed_scene.hpp"

namespace lostbits::test {

/// Sides between 2^-4 and 2^4, one in ten of them flat.
template <class S>
Box<S> draw_box(Random& random) {
    Box<S> box;
    for (int axis = 0; axis < 3; ++axis) {
        const double lo = 8 * random.unit() - 4;
        box.lo[axis] = static_cast<S>(lo);
        box.hi[axis] =
            random.one_in(10)
                ? box.lo[axis]
                : static_cast<S>(lo + std::ldexp(1 + random.unit(), static_cast<int>(random.between(-4, 3))));
    }
    return box;
}

/// A ray at the box: from anywhere near it or from one of its planes, at a point of it or a corner or past it; some
/// directions with zeros of either sign or a tiny component; one ray in three with any number at all in one place.
template <class S>
std::array<S, 6> draw_ray(Random& random, const Box<S>& box, std::size_t k) {
    std::array<S, 6> ray;
    for (int axis = 0; axis < 3; ++axis) {
        const S lo = box.lo[axis], hi = box.hi[axis];
        const auto a = static_cast<std::size_t>(axis);
        const double side = static_cast<double>(hi) - static_cast<double>(lo);
        ray[a] = static_cast<S>(12 * random.unit() - 6);
        if (random.one_in(4)) ray[a] = random.one_in(2) ? lo : hi;
        const auto target = static_cast<S>(static_cast<double>(lo) + (1.4 * random.unit() - 0.2) * side);
        ray[a + 3] = (random.one_in(5) ? hi : target) - ray[a];
        if (random.one_in(5)) ray[a + 3] = static_cast<S>(random.sign() * (random.one_in(4) ? 1e-30 : 0.0));
    }
    if (k % 3 == 2) ray[k / 3 % 6] = draw_any<S>(random);
    return ray;
}

/// Where a ray ends: before, in or behind what `draw_ray` aims at (t = 1), nowhere, or any number.
template <class S>
S draw_end(Random& random) {
    if (random.one_in(8)) return draw_any<S>(random);
    return random.one_in(4) ? std::numeric_limits<S>::infinity() : static_cast<S>(4 * random.unit());
}

}  // namespace lostbits::test
