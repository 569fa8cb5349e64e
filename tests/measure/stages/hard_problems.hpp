// Lists of hard rays, and the comparison of two truths of one ray.
#pragma once

#include <cstdlib>
#include <vector>

#include "measure/truth/hard_rays.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::test {

/// LOSTBITS_RAYS says how many.
inline const std::size_t rays_per_distribution = [] {
    const char* const text = std::getenv("LOSTBITS_RAYS");
    return text ? std::strtoull(text, nullptr, 10) : std::size_t{500};
}();

/// Number of rays of each distribution.
inline std::vector<HardRay> problems_of(Shape shape, const FloatFormat& storage, std::size_t each) {
    Seeded rng(14);
    std::vector<HardRay> problems;
    for (const HardDistribution& f : hard_distributions(shape, {storage}, Wide::yes))
        for (std::size_t i = 0; i < each; ++i) problems.push_back(f.draw(rng));
    return problems;
}

/// For the random distribution only.
inline std::vector<HardRay> random_problems(Shape shape, const FloatFormat& storage) {
    Seeded rng(17);
    std::vector<HardRay> problems;
    const HardDistribution random = hard_distributions(shape, {storage}).front();
    while (problems.size() < 20'000) problems.push_back(random.draw(rng));
    return problems;
}

/// True if both truths are the same, to within their bounds.
inline bool agree(const measure::truth::Truth& a, const measure::truth::Truth& b) {
    return a.decision == b.decision && a.primitive == b.primitive && a.touches == b.touches &&
           a.on_surface == b.on_surface && compare(a.t, b.t) == 0 && compare(a.distance, b.distance) == 0;
}

}  // namespace lostbits::test
