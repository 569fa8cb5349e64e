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

/// Of families: `for_each_cone(each, visit)` calls `visit(family, sample)` of each family so many times, every number
/// rounded to binary32: those of constructed rays are short, and stay. What has no direction, or breaks a limit of the
/// shape, is left out.
template <template <class> class S, std::size_t n>
struct ForEachSample {
    const SampledRays<S> (&families)[n];
    std::uint64_t seed;

    template <class Visit>
    void operator()(int each, const Visit& visit) const {
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
};
template <template <class> class S, std::size_t n>
ForEachSample(const SampledRays<S> (&)[n], std::uint64_t) -> ForEachSample<S, n>;

/// Solid and origin with all lengths k times as large.
template <template <class> class S>
Sample<S> scaled(const Sample<S>& s, double k) {
    Solid<double> solid(s.solid);
    std::size_t i = 0;
    for (const Key& key : S<double>::keys)
        for (std::size_t c = 0; c < key.count(); ++c, ++i)
            if (key.kind != Key::Kind::direction) solid.numbers[i] *= k;
    return {{k * s.ray.origin, s.ray.direction}, solid.as<S>()};
}
/// The same with a ray that comes from far below the first point of the solid.
template <template <class> class S>
Sample<S> scaled_from_below(Sample<S> s, double k) {
    s.ray = {Solid<double>(s.solid).point(0) + Vec<double>(7, 11, -300), Vec<double>(0.25, -0.5, 16)};
    return scaled(s, k);
}

}  // namespace lostbits::test
