// Families of rays at solids of one shape: each does one thing.
#pragma once

#include <cstdint>

#include "geometry/ray.hpp"
#include "measure/seeded.hpp"
#include "shapes/solid.hpp"

namespace lostbits::test {

using testing::Seeded;

template <template <class> class S>
struct Sample {
    Ray<double> ray;
    S<double> solid;
};

template <template <class> class S>
struct SampledRays {
    const char* name;
    Sample<S> (*make)(Seeded&);
};

/// `visit(family, sample)` of each family so many times, every number rounded to binary32: those of constructed rays
/// are short, and stay. What has no direction, or breaks a limit of the shape, is left out.
template <template <class> class S, std::size_t n, class Visit>
void for_each_sample(const SampledRays<S> (&families)[n], std::uint64_t seed, int each, const Visit& visit) {
    for (const SampledRays<S>& family : families) {
        Seeded rng(seed);
        for (int i = 0; i < each; ++i) {
            const Sample<S> drawn = family.make(rng);
            const Solid<double> solid =
                transformed(Solid<double>(drawn.solid), [](double x) { return testing::stored(x, binary32); });
            const Sample<S> s{
                {testing::stored(drawn.ray.origin, binary32), testing::stored(drawn.ray.direction, binary32)},
                solid.as<S>()};
            if (s.ray.direction != Vec<double>(0, 0, 0) && !broken_limit(solid)) visit(family, s);
        }
    }
}

}  // namespace lostbits::test
