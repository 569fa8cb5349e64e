// The parts of a report, each measured and ready for the page.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/sets.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/metric/metric_set.hpp"
#include "output/page/page.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::report {

using intersect::process::StopToken;

/// A scene under rows that fit it.
struct MapWork {
    scene::file::Scene scene;
    std::vector<measure::evaluate::TestedForm> rows;
    std::vector<const measure::metric::Metric*> metrics;
    bool own_size = true;          ///< the scene's own, not --size
    std::string named;             ///< what names the scene to a later command, in its size
    std::string claimed;           ///< and to a claim
    std::uint64_t unresolved = 0;  ///< after `map_part`: rays without a proved truth
};
/// `made` keeps the metrics that are made for it; `advance` is told of units of work done.
output::page::MapPart map_part(MapWork& work, measure::metric::MetricSet& made,
                               const std::function<void(std::uint64_t)>& advance, StopToken stop);

/// A sweep along one axis, over a plane, or over named cases, under rows that fit it.
struct SweepWork {
    std::filesystem::path path, data;
    std::vector<measure::evaluate::TestedForm> rows;
    int further_draws = 0;  ///< of random rays, for the spread of onsets
};
output::page::SweepPart sweep_part(const SweepWork& work, StopToken stop);

/// A scene and a wish, among rows that can be timed on it.
struct ChoiceWork {
    scene::file::Scene scene;
    measure::choice::Wish wish;
    std::vector<measure::evaluate::TestedForm> rows;
};
/// `SCENE:BITS`, or `SCENE:BITS:AT`, as the command line has it; `size` may be empty: the scene's. InputError, with
/// what to write, for any other word.
ChoiceWork choice_of(const std::string& word, const std::string& size, const selection::ChosenRows& rows,
                     const std::filesystem::path& data, StopToken stop);
/// Short measurements, as `lostbits choose --quick`.
output::page::ChoicePart choice_part(const ChoiceWork& work, StopToken stop);

/// A scene, a form and a wish.
struct MendWork {
    scene::file::Scene scene;
    measure::choice::Wish wish;
    measure::evaluate::TestedForm row;
};
/// `SCENE:FORM:BITS`, or `SCENE:FORM:BITS:AT` (without it every hit), in binary32; else as `choice_of`.
MendWork mend_of(const std::string& word, const std::string& size, const std::filesystem::path& data, StopToken stop);
/// Without prices, as `lostbits mend`.
output::page::MendPart mend_part(const MendWork& work, StopToken stop);
output::page::MendPart mend_part(const output::mend::MendResult& result);

/// The scenes of these names. NothingSelected for one that offsets cannot be measured of.
std::vector<scene::file::Scene> offset_scenes(const std::vector<std::string>& names, const std::string& size,
                                              const std::filesystem::path& data, StopToken stop);
/// Rays that leave the points of a scene, which `usual_forms` finds in `usual_format`. Nothing where no such form fits.
std::optional<output::page::OffsetPart> offset_part(const scene::file::Scene& scene, StopToken stop);

/// Short measurements of the rows of one shape.
output::page::TradePart trade_part(Shape shape, const std::vector<measure::evaluate::TestedForm>& rows, StopToken stop);

}  // namespace lostbits::analysis::report
