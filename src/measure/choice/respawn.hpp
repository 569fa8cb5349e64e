// With the choice, where the next ray may start.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::choice {

/// The strategies of offset that are right for every ray that leaves what a form has hit on a scene.
struct SafeOffsets {
    std::vector<offset::SafeStrategy> outside;  ///< for the rays away from the solid; the cheapest first
    std::vector<offset::SafeStrategy> both;     ///< also for those into it
    std::uint64_t points = 0, rays = 0;         ///< that this was measured on
};

/// On a picture of at most `pixels`, fewer where there are many solids. Nothing where the scene has too many, or the
/// form cannot be asked.
std::optional<SafeOffsets> safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& row,
                                        truth::TruthLimit limit = {}, int pixels = 1024);

}  // namespace lostbits::measure::choice
