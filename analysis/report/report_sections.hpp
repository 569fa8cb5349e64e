// Measures the sections of a report and makes them ready for the page.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/sets.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/metric/metric_set.hpp"
#include "output/report/page.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::report {

using intersect::process::StopToken;

/// A scene and the forms that can test it.
struct PlannedMap {
    scene::file::Scene scene;
    std::vector<measure::evaluate::TestedForm> tested_forms;
    std::vector<const measure::metric::Metric*> metrics;
    bool has_own_size = true;      ///< the scene's own, not --size
    std::string scene_arguments;   ///< arguments that name the scene, with its size, for a later command
    std::string name_in_claims;    ///< name of the scene in a claim
    std::uint64_t unresolved = 0;  ///< after `measure_map_section`: rays without a proved truth
};
/// Measures a map. `metric_set` owns the metrics that are made for the map; `advance` gets the units of work that are
/// done.
output::report::MapSection measure_map_section(PlannedMap& planned, measure::metric::MetricSet& metric_set,
                                               const std::function<void(std::uint64_t)>& advance, StopToken stop);

/// A sweep along one axis, over a plane, or over named cases, and the forms that can test it.
struct PlannedSweep {
    std::filesystem::path path, data;
    std::vector<measure::evaluate::TestedForm> tested_forms;
    int further_draw_count = 0;  ///< more draws of random rays, for the spread of onsets
};
output::report::SweepSection measure_sweep_section(const PlannedSweep& planned, StopToken stop);

/// A scene, a requirement, and the forms that can be timed on the scene.
struct PlannedChoice {
    scene::file::Scene scene;
    measure::choose::Requirement requirement;
    std::vector<measure::evaluate::TestedForm> tested_forms;
};
/// Parses `SCENE:BITS` or `SCENE:BITS:AT` of the command line. An empty `size` is the scene's. Throws InputError, which
/// says what to write, for other texts.
PlannedChoice parse_choice(const std::string& text, const std::string& size, const selection::SelectedForms& selected,
                           const std::filesystem::path& data, StopToken stop);
/// Chooses with short measurements, as `lostbits choose --quick` does.
output::report::ChoiceSection measure_choice_section(const PlannedChoice& planned, StopToken stop);

/// A scene, a form to repair and a requirement.
struct PlannedMend {
    scene::file::Scene scene;
    measure::choose::Requirement requirement;
    measure::evaluate::TestedForm tested_form;
};
/// Parses `SCENE:FORM:BITS` or `SCENE:FORM:BITS:AT`, for binary32. Without AT every hit must keep the bits. Otherwise
/// like `parse_choice`.
PlannedMend parse_mend(const std::string& text, const std::string& size, const std::filesystem::path& data,
                       StopToken stop);
/// Repairs the form without measuring times, as `lostbits mend` does without --price.
output::report::MendSection measure_mend_section(const PlannedMend& planned, StopToken stop);
output::report::MendSection make_mend_section(const output::repair::RepairSummary& result);

/// A study and a scene that it takes.
struct PlannedStudy {
    std::string study;
    scene::file::Scene scene;
};
/// Parses `STUDY:SCENE`. Throws InputError, which says what to write, for other texts.
PlannedStudy parse_study(const std::string& text, const std::string& size, const std::filesystem::path& data,
                         StopToken stop);
/// Measures the study with these forms and formats; the usual ones of the study if none is named. Throws
/// NothingSelected if none of the forms fits.
output::report::StudySection measure_study_section(const PlannedStudy& planned, const std::vector<std::string>& forms,
                                                   const std::vector<std::string>& formats, StopToken stop);

/// Loads the scenes of these names. Throws NothingSelected for a scene on which offsets cannot be measured.
std::vector<scene::file::Scene> load_offset_scenes(const std::vector<std::string>& names, const std::string& size,
                                                   const std::filesystem::path& data, StopToken stop);

/// Measures speed and accuracy of the forms of one shape, with short measurements.
output::report::TradeSection measure_trade_section(Shape shape,
                                                   const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                                   StopToken stop);

}  // namespace lostbits::analysis::report
