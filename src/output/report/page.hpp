// One self-contained HTML file: it loads nothing else, has a strict content security policy, and is readable without
// scripts.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/check/claim.hpp"
#include "measure/offset/offsets.hpp"
#include "output/check/claim_files.hpp"
#include "output/choose/choice_files.hpp"
#include "output/repair/repair_files.hpp"
#include "output/report/map_data.hpp"

namespace lostbits::output::report {

/// A PNG, and a text that describes it for readers who do not see it.
struct Picture {
    std::string alt;
    std::string png;  ///< bytes of the PNG file
};

/// An SVG, a text that describes it, and the name by which the page's script finds it: `lost_bits_p99.f32`.
struct Chart {
    std::string alt;
    std::string svg;
    std::string name = {};
    bool is_plot = true;  ///< the chart has lines or points, and its colours only tell these apart
};

/// Lets `draw` write a picture to a file and reads the file back. Throws EnvironmentError if it cannot be read.
[[nodiscard]] Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw);

/// A map of a scene.
struct MapSection {
    std::string id, title, note, source;
    std::vector<std::string> tested_form_names;  ///< `map::tested_form_name` of each row
    Json index;                                  ///< from `MapData::index`
    std::vector<NamedData> named_data;
    std::string table;  ///< HTML, see `summary_table`
    Picture sheet;
    bool has_scene_size = true;  ///< the map has the scene's own size, so claims are measured on the same rays
    std::vector<std::string> metrics = {};  ///< names of the metrics
    std::string finding = {};               ///< from `map::finding_text`
    std::size_t wrong_row_count = 0;        ///< number of rows that decide a ray wrongly
};

/// A sweep along one axis or over a plane, or a file of cases.
struct SweepSection {
    enum class Kind { line, plane, cases };
    Kind kind = Kind::line;
    std::string id, title, note, source;
    std::vector<std::string> tested_form_names;  ///< `map::tested_form_name` of each row
    std::vector<std::vector<double>> axes = {};  ///< values of each axis in the order of the page; empty for cases
    std::vector<std::string> cases = {};
    Json json = {};  ///< from `sweep_json`, `plane_json` or `case_json`
    std::string table = {};
    std::vector<Chart> charts = {};
};

struct TradeSection {
    std::string shape;
    Json json;                  ///< from `trade_json`
    std::string text;           ///< the results as `lostbits trade` prints them
    std::vector<Chart> charts;  ///< one for each set of rays, with the name of the set
};

/// The form chosen for a scene by a requirement. The times differ from run to run.
struct ChoiceSection {
    std::string scene, requirement;  ///< id of the scene; `18 correct bits of every hit, no wrong decision`
    std::string text;                ///< sentences, of which the second line is the answer
    std::string table;               ///< HTML, see `choice_table`
    Chart front_chart;               ///< time against kept bits
};

/// The repair of a form for a scene and a requirement.
struct MendSection {
    std::string form, scene, requirement;  ///< `sphere.half_b in f32`, the scene's id, the requirement
    std::vector<std::string> changes;      ///< one sentence for each form that the repair produced
    std::string text;                      ///< from `repair::repair_text`
    std::string table;                     ///< HTML, see `mend_table`
    Chart front_chart;                     ///< time, or the number of wider operations, against kept bits
    bool has_times = false;                ///< times differ from run to run
};

/// A study of a scene, such as consistency.
struct StudySection {
    std::string study, purpose;                ///< name of the study, and a text that says what it measures
    std::string id, title, note, source = {};  ///< texts of the scene
    std::vector<std::string> sentences = {};   ///< findings
    std::string table = {};                    ///< HTML, see `study_table` and `offset_table`
    Picture sheet = {};
    /// Fractions of rays that go wrong, for each side and each of `all_strategies`. Only in a section of offsets.
    std::array<std::vector<double>, 2> wrong_fractions = {};
};

struct Report {
    std::string command;  ///< the command that makes the page again
    std::vector<MapSection> maps;
    std::vector<SweepSection> sweeps;
    std::vector<TradeSection> trades;
    std::vector<ChoiceSection> choices = {};
    std::vector<MendSection> mends = {};
    std::vector<StudySection> offsets = {}, studies = {};
    std::vector<scene::check::Claim> claims;
    std::vector<measure::check::ClaimResult> results;
    std::string processor = {};  ///< processor on which the times were measured; empty if unknown
    std::string program = {};    ///< program that made the page: `lostbits 0.1.0`
};

/// Table of the forms and formats of a map: decisions, and p50, p99 and max of lost bits. If too few hits agree, the
/// quantiles are withheld. Each number carries the decimal of the CSV.
[[nodiscard]] std::string summary_table(const MapStudy& study, const std::vector<FormSummary>& summaries);

/// Table of every form and format, cheapest first: time, bits kept, wrong decisions, and whether it meets the
/// requirement.
[[nodiscard]] std::string choice_table(const choose::ChoiceResult& chosen);

/// Table of the form, its repairs and the best form of the catalogue: wider operations, bits kept and wrong decisions
/// on the scene and on rays that the search did not use, and times if they were measured. Each number carries the CSV's
/// own decimal.
[[nodiscard]] std::string mend_table(const repair::RepairSummary& result);

/// One table per side: the fraction of rays that each strategy gets wrong, the kinds of errors, and the factor by which
/// the offset is too large.
[[nodiscard]] std::string offset_table(const measure::offset::OffsetStudy& study,
                                       const std::vector<measure::offset::OffsetSummary>& summaries);

/// One table per side with a row per strategy and a column per scene: the fraction of rays that go wrong.
[[nodiscard]] std::string offset_overview(const std::vector<StudySection>& parts);

/// Table of a study's summary: its columns, except those that are empty in every row and those of commands.
[[nodiscard]] std::string study_table(const std::vector<file::Column>& columns,
                                      const std::vector<std::vector<file::Cell>>& rows);

/// Counts of the verdicts as a row of tiles, the gravest first.
[[nodiscard]] std::string verdict_tiles(const check::VerdictCounts& counts);
/// One table per subject, with a row per claim. If the page shows what the claim was measured on, the row links there.
[[nodiscard]] std::string claims_table(const Report& report);

/// Makes the page; the same report gives the same bytes.
[[nodiscard]] std::string page(const Report& report);

}  // namespace lostbits::output::report
