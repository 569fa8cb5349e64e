#include <algorithm>

#include "measure/truth/ray_builders.hpp"

namespace lostbits::test {

// t = T·2^q with T an odd integer: half way between two numbers of a format, among them the boundary of overflow and
// half the smallest subnormal. The ray runs along an axis: t·|d| = (c − o) − half a chord, all integers.
RaySample draw_tie(Seeded& rng, const FloatFormat& storage) {
    static constexpr FloatFormat formats[] = {binary64, binary32, binary16, bfloat16};
    const bool narrow = storage == binary32;
    const FloatFormat f = formats[narrow ? 1 + rng.index(3) : rng.index(4)];
    const std::int64_t normal = std::int64_t{1} << (f.precision - 1);
    // The lower neighbour's significand and binade.
    std::int64_t lower = normal + static_cast<std::int64_t>(rng.bits(f.precision - 1));
    int binade = static_cast<int>(rng.integer(f.emin, f.emax));
    switch (rng.index(6)) {
        case 0: lower = rng.integer(0, std::min<std::int64_t>(normal - 1, 5)), binade = f.emin; break;  // subnormal
        case 1:
            lower = 2 * normal - 1, binade = rng.coin() ? f.emax : binade;
            break;  // into the next binade, or overflow
        case 2: lower = rng.integer(0, normal - 1), binade = f.emin; break;
        default: break;
    }
    const std::int64_t ticks =
        2 * lower + (rng.index(8) == 0 ? 0 : 1);  // in half places; the even ones are exact numbers
    const int q = binade - f.precision;

    // Pythagoras again: at height 3k or 5k a sphere of radius 5k or 13k has half a chord of 4k or 12k.
    const std::int64_t k = rng.integer(1, 50);
    static constexpr PythagoreanTriple shapes[] = {{0, 1, 1}, {3, 4, 5}, {5, 12, 13}};
    const PythagoreanTriple shape = shapes[rng.index(3)];
    const std::int64_t x = ticks + shape.q * k;
    const std::int64_t low = x % (std::int64_t{1} << 14);
    RaySample s{{{static_cast<double>(-low), static_cast<double>(shape.p * k), 0}, {1, 0, 0}},
                {{static_cast<double>(x - low), 0, 0}, static_cast<double>(shape.hypotenuse * k)}};
    // Lengths and direction share q as the storage allows.
    const int lengths = std::clamp(q / 2, storage.emin, storage.emax - 60);
    return rescale(shuffle_axes(rng, s), lengths, lengths - q);
}

// A tie and a little: (c − o) ∓ r with a sphere so small, or an origin so close to the centre, that only a proof of
// hundreds of bits tells the side.
RaySample draw_near_tie(Seeded& rng, const FloatFormat& storage) {
    const int p = storage.precision;
    const double whole = std::ldexp(1.0, p) + static_cast<double>(2 * rng.bits(p - 2));  // ≥ 2^p: neighbours 2 apart
    const int below = static_cast<int>(rng.integer(3, -storage.emin - 60));
    const double little = std::ldexp(static_cast<double>(rng.integer(1, 7)), -below);
    RaySample s{{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, 1}};
    if (rng.coin()) {
        s.ray.origin.x = -1;
        s.sphere = {{whole, 0, 0}, little};
    } else {
        s.ray.origin.x = rng.coin() ? little : -little;
        s.sphere = {{rng.sign(), 0, 0}, whole};
    }
    const int lengths = static_cast<int>(rng.integer(-40, 40)), direction = static_cast<int>(rng.integer(-50, 50));
    return rescale(shuffle_axes(rng, s), lengths, direction);
}

namespace {

RaySample draw_small_scene(Seeded& rng) {
    switch (rng.index(3)) {
        case 0: return draw_integer_tangent(rng, binary32);
        case 1: return draw_integer_contact(rng, binary32);
        default: return draw_integer_scene(rng);
    }
}

/// A direction's scale: with the lengths, about one, or at either end of the range.
int draw_scale(Seeded& rng, const FloatFormat& format) {
    const int lowest = format.emin - format.precision + 1, highest = format.emax - 24;
    switch (rng.index(4)) {
        case 0: return lowest + rng.index(8);
        case 1: return static_cast<int>(rng.integer(-20, 20));
        case 2: return highest - rng.index(8);
        default: return static_cast<int>(rng.integer(lowest, highest));
    }
}

}  // namespace

RaySample draw_subnormal(Seeded& rng, const FloatFormat& storage) {
    const int lowest = storage.emin - storage.precision + 1;
    if (rng.index(4) != 0) {  // integers in units of the smallest subnormal: all of the geometry is down there
        const RaySample s = draw_small_scene(rng);
        const bool direction_only = rng.index(3) == 0;
        const int lengths = direction_only ? static_cast<int>(rng.integer(-20, 20)) : lowest + rng.index(30);
        return rescale(s, lengths, direction_only ? lowest + rng.index(8) : draw_scale(rng, storage));
    }
    // Any of the four subnormal, the others not.
    const auto number = [&](bool tiny) {
        const double k = static_cast<double>(rng.integer(-(1 << 20), 1 << 20));
        return std::ldexp(k, tiny ? lowest + rng.index(3) : -rng.index(30));
    };
    const bool o = rng.coin(), d = rng.coin(), c = rng.coin(), r = rng.coin();
    RaySample s{{{number(o), number(o), number(o)}, {number(d), number(d), number(d)}},
                {{number(c), number(c), number(c)}, 0}};
    while (s.sphere.radius == 0) s.sphere.radius = std::fabs(number(r));
    if (rng.coin()) {  // along an axis through the centre, so that a tiny sphere can be hit at all
        const double height = rng.coin() ? s.sphere.radius : 0.0;
        s.ray.direction = {s.ray.direction.x, 0, 0};
        s.ray.origin.y = s.ray.origin.z = s.sphere.centre.y = s.sphere.centre.z = 0;
        s.ray.origin.z = height;
    }
    if (dot(s.ray.direction, s.ray.direction) == 0) s.ray.direction.x = std::ldexp(1.0, lowest);
    return shuffle_axes(rng, s);
}

RaySample draw_overflowing(Seeded& rng, const FloatFormat& storage) {
    const int highest = storage.emax - 24;
    const int lengths =
        rng.index(3) == 0 ? storage.emax / 2 + rng.index(storage.emax / 2 - 24) : highest - rng.index(10);
    const int direction = draw_scale(rng, storage);
    return rescale(draw_small_scene(rng), lengths, direction);
}

RaySample draw_mixed_exponents(Seeded& rng, const FloatFormat& storage) {
    const int lowest = storage.emin - storage.precision + 1, highest = storage.emax - 1;
    const auto number = [&] { return rng.index(10) == 0 ? 0.0 : rng.signed_magnitude(lowest, highest); };
    RaySample s{{{number(), number(), number()}, {number(), number(), number()}}, {{number(), number(), number()}, 0}};
    s.sphere.radius = rng.magnitude(lowest, highest);
    if (rng.coin()) {  // aimed at the centre as well as rounding allows, radius within 60 binades of the distance
        const Vec<double> away = s.sphere.centre - s.ray.origin;
        const double size = std::max({std::fabs(away.x), std::fabs(away.y), std::fabs(away.z)});
        const int direction = static_cast<int>(rng.integer(-60, 0));
        s.ray.direction = {std::ldexp(away.x, direction), std::ldexp(away.y, direction), std::ldexp(away.z, direction)};
        if (size > 0 && size < std::ldexp(1.0, highest)) s.sphere.radius = size * rng.magnitude(-60, 0);
    }
    s = stored(s, storage);
    const auto finite = [&](double x) { return std::fabs(x) < std::ldexp(1.0, storage.emax); };
    for (int i = 0; i < 3; ++i)
        if (!finite(s.ray.direction[i])) s.ray.direction[i] = 1;
    if (s.ray.direction == Vec<double>(0, 0, 0)) s.ray.direction[rng.index(3)] = std::ldexp(1.0, lowest);
    if (s.sphere.radius == 0) s.sphere.radius = std::ldexp(1.0, lowest);
    return s;
}

// The tangent point lies at t = 2^p + n + τ: half way between two numbers when n is odd, but for τ, which lies up to
// two thousand places below. f = −t·(3, 4) + ρ·(4, −3), r = 5ρ; each component of f is a difference of two stored
// numbers, one for the large part and one for τ. With ρ = 3·2^(p−2) + δ the large parts are 4δ − 3n and
// −25·2^(p−2) − (4n + 3δ), which fit p bits where 4n + 3δ is a multiple of 8; so does 5ρ where δ is one of 4.
RaySample draw_wide_tangent(Seeded& rng, const FloatFormat& storage) {
    const int p = storage.precision;
    const double quarter = std::ldexp(1.0, p - 2);
    const std::int64_t n = 2 * rng.integer(0, 1000) + 1;
    const std::int64_t delta = 8 * rng.integer(-100, 100) + 4;
    const int lengths = static_cast<int>(rng.integer(-20, storage.emax - p - 20));
    const int tau_exponent = static_cast<int>(rng.integer(storage.emin - p + 1, lengths - 5));
    const double tau = std::ldexp(rng.sign(), tau_exponent);
    const auto large = [&](double x) { return std::ldexp(x, lengths); };
    const double x = static_cast<double>(4 * delta - 3 * n), y = -25 * quarter - static_cast<double>(4 * n + 3 * delta);
    const double radius = 15 * quarter + static_cast<double>(5 * delta);
    const RaySample s{{{large(x), large(y), 0}, {3, 4, 0}}, {{3 * tau, 4 * tau, 0}, large(radius)}};
    const int direction = static_cast<int>(rng.integer(-20, 20));
    return rescale(shuffle_axes(rng, s), 0, direction);
}

// The origin on the surface, but for a centre moved by τ·n: c = τ² n·n − 2 τ f·n. Where n ⟂ f that is τ²: four thousand
// places below r², and it alone tells inside from outside; where d ⟂ f, h = −τ n·d tells leaving from entering.
RaySample draw_wide_contact(Seeded& rng, const FloatFormat& storage) {
    const Frame frame = draw_frame(rng, 3);
    const PythagoreanTriple triple = draw_triple(rng, 50);
    const int lengths = static_cast<int>(rng.integer(-20, storage.emax - 20));
    const int tau = static_cast<int>(rng.integer(storage.emin - storage.precision + 1, lengths - 5));
    const Vec<double> f = combine(0, frame.u, triple.p, frame.v, triple.q, frame.w);
    const auto way = [&] {
        const std::int64_t p = rng.integer(-3, 3), q = rng.integer(-3, 3);
        switch (rng.index(4)) {
            case 0: return combine(p == 0 ? 1 : p, frame.u, 0, frame.v, 0, frame.w);
            case 1: return combine(p, frame.u, -triple.q, frame.v, triple.p, frame.w);  // perpendicular to f, too
            case 2: return combine(1, frame.u, p, frame.v, q, frame.w);
            default: return combine(p, frame.u, triple.p, frame.v, triple.q, frame.w);
        }
    };
    RaySample s{{f, way()}, {{0, 0, 0}, static_cast<double>(triple.hypotenuse * frame.length)}};
    s = rescale(s, lengths, static_cast<int>(rng.integer(-20, 20)));
    const Vec<double> n = way();
    for (int i = 0; i < 3; ++i) s.sphere.centre[i] = std::ldexp(n[i], tau);
    return s;
}

}  // namespace lostbits::test
