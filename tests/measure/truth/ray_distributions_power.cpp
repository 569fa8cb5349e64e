// Rays whose t or distance is a power of two exactly, or by less than a bound of 2^-72 can tell.
#include <cmath>

#include "measure/truth/ray_builders.hpp"

namespace lostbits::test {
namespace {

Vec<double> plus(const Vec<double>& a, const Vec<double>& b, double by) {
    return {a.x + by * b.x, a.y + by * b.y, a.z + by * b.z};
}

/// A small integer vector, not zero.
Vec<double> integers(Seeded& rng, int largest) {
    const auto draw = [&] { return static_cast<double>(rng.index(2 * largest + 1) - largest); };
    for (;;) {
        const Vec<double> v(draw(), draw(), draw());
        if (v.x != 0 || v.y != 0 || v.z != 0) return v;
    }
}

/// The sample with its exponents moved, which moves powers of two to powers of two.
RaySample anywhere(Seeded& rng, const RaySample& sample) {
    return shuffle_axes(rng, rescale(sample, rng.index(41) - 20, rng.index(41) - 20));
}

}  // namespace

/// t = 2^k at a point of the sphere: from outside, from inside, or the far root's of a ray that starts between.
RaySample draw_power_contact(Seeded& rng, const FloatFormat&) {
    const Frame f = draw_frame(rng, 4);
    const Vec<double> direction = integers(rng, 12), centre = integers(rng, 50);
    const double k = std::ldexp(1.0, rng.index(5));
    const Vec<double> radius = combine(1, f.u, 0, f.v, 0, f.w);
    return anywhere(
        rng, {{plus(plus(centre, radius, 1), direction, -k), direction}, {centre, static_cast<double>(f.length)}});
}

/// From the centre, or at right angles to the way there, the distance is a power of two in every direction, |d|
/// rational or not.
RaySample draw_power_distance(Seeded& rng, const FloatFormat&) {
    const Vec<double> origin = integers(rng, 50), direction = integers(rng, 30);
    if (rng.coin()) return anywhere(rng, {{origin, direction}, {origin, std::ldexp(1.0, rng.index(6))}});
    // f = (p, 0, 0) and d = (0, y, z): distance² = r² − p², with (p, 2^k, r) of a triple such as 3, 4, 5.
    constexpr double triples[][2] = {{3, 5}, {15, 17}, {63, 65}, {255, 257}};  // with 4, 8 (of 8-15-17), 16, 32
    const auto& [p, r] = triples[rng.index(4)];
    Vec<double> across(0, direction.y, direction.z);
    if (across.y == 0 && across.z == 0) across.y = 1;
    return anywhere(rng, {{{origin.x + p, origin.y, origin.z}, across}, {origin, r}});
}

/// The case that was found: an exact tangent at a distance of 2^k, with a direction whose length is no power of two.
RaySample draw_power_tangent(Seeded& rng, const FloatFormat& storage) {
    const double size = storage == binary32 ? 0x951115p-24 : 0x951114a098f0fp-52;
    const double radius = std::ldexp(size, rng.index(9) - 4), far = std::ldexp(1.0, rng.index(9));
    constexpr double lengths[] = {3, 5, 7, 11, 1.25};
    const double length = lengths[rng.index(5)];
    return shuffle_axes(rng, {{{radius, 0, -far}, {0, 0, length}}, {{0, 0, 0}, radius}});
}

/// A tiny sphere about the point at t = 2^k: t lies below by 2^-100 of it or less, or, from behind its centre, the far
/// root above.
RaySample draw_power_beside(Seeded& rng, const FloatFormat& storage) {
    const Vec<double> direction = integers(rng, 1 << 10);
    const double k = std::ldexp(1.0, rng.index(9) - 4);
    const int smallest = storage == binary32 ? -100 : -300;
    const double radius = std::ldexp(1.0 + rng.index(8) / 8.0, -75 - rng.index(-75 - smallest));
    const Vec<double> at = plus({0, 0, 0}, direction, k);
    return shuffle_axes(rng, {{{0, 0, 0}, direction}, {at, radius}});
}

}  // namespace lostbits::test
