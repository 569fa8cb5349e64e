// The strategy to take: the cheapest that is right for every ray of a scene.
#pragma once

#include <span>
#include <vector>

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::offset {

/// A strategy with which no respawned ray goes wrong.
struct SafeStrategy {
    const Strategy* strategy;
    /// What one new ray costs, in operations as the rule is written (`Strategy::operations`): a count, not a time.
    std::uint64_t operations;
    double oversize;  ///< how many times larger than needed, the median over the sides; NaN where nothing is needed
};

/// Those of a measured row to all of these sides, the cheapest first; of equally cheap ones in the order of the table.
/// Safe is `StrategySummary::bad` = 0: no self-hit by truth or by the form, no occluder and no way out lost. Empty
/// where none is, and where there is no point.
std::vector<SafeStrategy> safe_strategies(const OffsetSummary& summary, const std::vector<const Strategy*>& strategies,
                                          Shape shape, std::span<const Side> sides = both_sides);

/// The same for a form and format on a scene, whose rays and points it measures first: what `choose` asks.
std::vector<SafeStrategy> safe_strategies(const scene::file::Scene& scene, const OffsetRow& row,
                                          std::span<const Side> sides = both_sides);

}  // namespace lostbits::measure::offset
