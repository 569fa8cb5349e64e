// Rays that forms meet and rays that break them, seeded.
#pragma once

#include "intersect/exact.hpp"
#include "number/random.hpp"

namespace lostbits::test {

enum class Setup {
    near,
    far,
    inside,
    behind,
    beside,
    almost_tangent,
    just_above_huge,
    just_below_huge,
    away_from_world
};
inline constexpr Setup every_setup[] = {Setup::near,
                                        Setup::far,
                                        Setup::inside,
                                        Setup::behind,
                                        Setup::beside,
                                        Setup::almost_tangent,
                                        Setup::just_above_huge,
                                        Setup::just_below_huge,
                                        Setup::away_from_world};

inline std::array<double, 3> draw_unit(Random& random) {
    for (;;) {
        const std::array<double, 3> v{2 * random.unit() - 1, 2 * random.unit() - 1, 2 * random.unit() - 1};
        const double size = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if (size < 0.01 || size > 1) continue;
        const double inverse = 1 / std::sqrt(size);
        return {v[0] * inverse, v[1] * inverse, v[2] * inverse};
    }
}

/// Every number has at most 53 bits, except an almost tangent radius, which lies 2^-30 to 2^-60 beside the tangent one.
inline Case draw_case(Random& random, Setup setup) {
    const bool huge = setup == Setup::just_above_huge || setup == Setup::just_below_huge;
    const double radius =
        huge ? std::ldexp(1 + random.unit(), static_cast<int>(random.between(20, 60))) : 0.25 + 4 * random.unit();
    double distance = radius * (1.01 + 9 * random.unit());
    if (setup == Setup::far) distance = radius * 1e6 * (1 + random.unit());
    if (setup == Setup::inside) distance = radius * 0.99 * random.unit();
    if (setup == Setup::just_above_huge)
        distance = radius * (1 + std::ldexp(1 + random.unit(), -static_cast<int>(random.between(8, 50))));
    if (setup == Setup::just_below_huge)
        distance = radius * (1 - std::ldexp(1 + random.unit(), -static_cast<int>(random.between(8, 50))));

    const auto centre = draw_unit(random), side = draw_unit(random);
    auto towards = draw_unit(random);
    const double world = setup == Setup::away_from_world ? 1e5 : setup == Setup::near ? 3.0 : 0.0;
    // Aim at the centre, off by a part of the radius; `behind` looks the other way, `beside` aims past the sphere.
    double off = setup == Setup::beside ? 1.5 + random.unit() : 1.1 * random.unit();
    if (setup == Setup::almost_tangent) off = 1;
    const double look = setup == Setup::behind || (setup == Setup::inside && random.one_in(2)) ? -1 : 1;
    const double scale =
        std::ldexp(1 + random.unit(), random.one_in(2) ? 0 : static_cast<int>(random.between(-60, 60)));

    Case x;
    x.radius = radius;
    std::array<double, 3> d{};
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        d[i] = look * (towards[i] + side[i] * off * radius / std::max(distance, radius));
        longest = std::max(longest, std::fabs(d[i]));
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const double g = world * centre[i];
        x.centre[i] = g;
        x.origin[i] = g - distance * towards[i];
        x.direction[i] = scale * d[i] / longest;
    }
    if (setup == Setup::almost_tangent) {
        const Rational one(1),
            beside(1, boost::multiprecision::mpz_int(1) << static_cast<unsigned>(random.between(30, 60)));
        x.radius = rational_from(BasicReal<140>(sqrt(real_from<Precise>(line_distance_squared(x))))) *
                   (random.one_in(2) ? one + beside : one - beside);
    }
    return x;
}

inline double as_double(const Rational& q) { return real_from<BasicReal<53>>(q).convert_to<double>(); }

/// The case as it would be stored: every number rounded to S; the direction normalised first where a form asks for
/// that.
template <class S>
Case as_stored(Case x, intersect::Direction direction = intersect::Direction::any) {
    const auto round = [](Rational& q) { q = Rational(static_cast<double>(static_cast<S>(as_double(q)))); };
    for (auto* v : {&x.origin, &x.direction, &x.centre})
        for (Rational& q : *v) round(q);
    round(x.radius);
    if (direction == intersect::Direction::unit) {
        const double dx = as_double(x.direction[0]), dy = as_double(x.direction[1]), dz = as_double(x.direction[2]);
        const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
        x.direction = {Rational(dx / length), Rational(dy / length), Rational(dz / length)};
        for (Rational& q : x.direction) round(q);
    }
    return x;
}

}  // namespace lostbits::test
