// Rays that meet the rest of a torus in one point, and tori of any size: the hardest problems for a filter.
#pragma once

#include <cmath>
#include <limits>

#include "exact/draw.hpp"

namespace lostbits::exact {

/// Tori of small whole numbers, and rays that meet them in one point: along the top, in the plane along either equator,
/// along the axis beside the rim of the hole or through the middle, through both sides at once. `horn`: the hole is one
/// point. One number in six may be moved by an ulp.
template <class F>
Problem beside_torus(Chance& chance, bool horn) {
    const auto whole = [&](int n) { return static_cast<double>(1 + chance.below(n)); };
    const auto side = [&] { return chance.below(2) == 0 ? 1.0 : -1.0; };
    const double minor = 5 * whole(6), major = horn ? minor : minor + 5 * whole(6), away = whole(60);
    const double edge = chance.below(2) == 0 ? major + minor : major - minor;
    std::array<double, 3> o{-4 * away, 3 * away, side() * minor}, d{4, -3, 0};
    switch (chance.below(5)) {
        case 0: break;
        case 1: o = {edge / 5 * 3 - 4 * away, edge / 5 * 4 + 3 * away, 0}; break;
        case 2: o = {edge / 5 * 3, edge / 5 * 4, away}, d = {0, 0, -whole(4)}; break;
        case 3: o = {0, 0, away}, d = {chance.below(2) * whole(3), 0, -whole(3)}; break;
        default: o = {-4 * away, 3 * away, side() * minor * away / major}, d = {4 * major, -3 * major, -minor}; break;
    }
    const double scale = std::ldexp(1.0, chance.below(81) - 40), heads = chance.below(6) == 0 ? side() : 1;
    std::array<double, 3> centre{};
    if (chance.below(2) == 0) centre = {whole(99) - 50, whole(99) - 50, whole(99) - 50};
    Problem p{};
    for (std::size_t i = 0; i < 3; ++i)
        p.ray[i] = scale * (o[i] + centre[i]), p.ray[3 + i] = heads * d[i], p.primitive[i] = scale * centre[i];
    p.primitive[5] = side() * whole(3), p.primitive[6] = scale * major, p.primitive[7] = scale * minor;
    if (const std::size_t k = static_cast<std::size_t>(chance.below(72)); k < 12) {
        double& x = k < 6 ? p.ray[k] : p.primitive[k - 6];
        if (x != 0) x = std::nextafter(static_cast<F>(x), chance.below(2) == 0 ? F(0) : std::numeric_limits<F>::max());
    }
    for (double& x : p.ray) x = static_cast<F>(x);
    return p;
}

/// Numbers of all sizes, some of which form a primitive.
template <class F>
Problem torus_of_any_size(Chance& chance) {
    const int most = sizeof(F) == 4 ? 126 : 300;
    const auto number = [&] { return stored<F>(std::ldexp(chance.part(), chance.below(2 * most) - most)); };
    Problem p{};
    for (double& x : p.ray) x = number();
    for (std::size_t k = 0; k < 6; ++k) p.primitive[k] = chance.below(3) == 0 ? 0 : number();
    p.primitive[5] = number();
    const double one = std::fabs(number()), other = std::fabs(number());
    p.primitive[6] = std::fmax(one, other), p.primitive[7] = std::fmin(one, other);
    return p;
}

}  // namespace lostbits::exact
