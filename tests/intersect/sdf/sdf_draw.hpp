// Random targets of marches: unions of spheres and boxes about the origin, and rays toward them.
#pragma once

#include "intersect/target.hpp"
#include "number/draw.hpp"

namespace lostbits::test {

struct DrawnField {
    std::vector<Primitive<double>> primitives;
    intersect::MarchConstants<double> march{};
    std::vector<Ray<double>> rays;

    [[nodiscard]] intersect::Target<double> target() const { return {primitives, march}; }
};

/// Every number is one of binary32. Directions are unit to binary32's rounding.
inline DrawnField draw_field(Random& random, std::size_t rays) {
    const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    const auto within = [&](double a, double b) { return stored(a + (b - a) * random.unit()); };
    DrawnField f;
    const auto count = static_cast<std::size_t>(random.between(1, 4));
    for (std::size_t k = 0; k < count; ++k) {
        const Vec<double> at(within(-1, 1), within(-1, 1), within(-1, 1));
        if (random.one_in(2)) f.primitives.emplace_back(Sphere<double>{at, within(0.25, 1)});
        else
            f.primitives.emplace_back(Box<double>{
                at, {stored(at.x + within(0.1, 1)), stored(at.y + within(0.1, 1)), stored(at.z + within(0, 1))}});
    }
    f.march = {stored(std::ldexp(1, -static_cast<int>(random.between(4, 20)))),
               within(4, 40),
               stored(1e-3),
               stored(2e-3),
               within(1, 1.9),
               static_cast<int>(random.between(1, 80)),
               2,
               6};
    for (std::size_t i = 0; i < rays; ++i) {
        const Vec<double> origin(within(-4, 4), within(-4, 4), within(-4, 4)),
            aim(within(-1.5, 1.5), within(-1.5, 1.5), within(-1.5, 1.5));
        const Vec<double> d = aim - origin;
        const double size = length(d);
        f.rays.push_back({origin, {stored(d.x / size), stored(d.y / size), stored(d.z / size)}});
    }
    return f;
}

}  // namespace lostbits::test
