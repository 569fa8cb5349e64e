// The parts of a report, each measured and ready for the page.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/metric/metric_set.hpp"
#include "output/page/page.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis {

/// Told of units of work done; may throw to stop.
using Advance = std::function<void(std::uint64_t)>;

/// A scene under rows that fit it.
struct MapWork {
    scene::file::Scene scene;
    std::vector<measure::map::MapRow> rows;
    std::vector<const measure::metric::Metric*> metrics;
    bool own_size = true;          ///< the scene's own, not --size
    std::uint64_t unresolved = 0;  ///< after `map_part`: rays without a proved truth
};
/// `made` keeps the metrics that are made for it.
output::page::MapPart map_part(MapWork& work, measure::metric::MetricSet& made, const Advance& advance);

/// A sweep along one axis, over a plane, or over named cases, under rows that fit it.
struct SweepWork {
    std::filesystem::path path, data;
    std::vector<measure::map::MapRow> rows;
    int further_draws = 0;  ///< of random rays, for the spread of onsets
};
output::page::SweepPart sweep_part(const SweepWork& work, const Advance& advance);

/// Short measurements of the rows of one shape.
output::page::TradePart trade_part(Shape shape, const std::vector<measure::map::MapRow>& rows, const Advance& advance);

}  // namespace lostbits::analysis
