// One self-contained HTML file: no request beyond it, a strict policy, readable without scripts.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"
#include "measure/offset/offsets.hpp"
#include "output/choice/choice_files.hpp"
#include "output/claim/claim_files.hpp"
#include "output/mend/mend_files.hpp"
#include "output/page/map_data.hpp"

namespace lostbits::output::page {

/// A PNG and what it shows.
struct Picture {
    std::string alt;
    std::string png;       ///< its bytes
    bool is_plot = false;  ///< lines or points on paper, whose colours mean nothing but which is which
};

/// What `draw` writes into the file that it is given. EnvironmentError when it cannot be read back.
[[nodiscard]] Picture picture(std::string alt, const std::function<void(const std::filesystem::path&)>& draw,
                              bool is_plot = false);

struct MapPart {
    std::string id, title, note, source;
    std::vector<std::string> rows;  ///< `map::row_name` of each
    Json index;                     ///< of `MapData::index`
    std::vector<Blob> blobs;
    std::string table;  ///< HTML, see `summary_table`
    Picture sheet;
    bool own_size = true;                   ///< the scene's: claims are measured on the same rays
    std::vector<std::string> metrics = {};  ///< their names
};

/// A sweep along one axis or over a plane, or a file of cases.
struct SweepPart {
    enum class Kind { line, plane, cases };
    Kind kind = Kind::line;
    std::string id, title, note, source;
    std::vector<std::string> rows;               ///< `map::row_name` of each
    std::vector<std::vector<double>> axes = {};  ///< the values of each as the page numbers them; of cases none
    std::vector<std::string> cases = {};
    Json json = {};  ///< of `sweep_json`, `plane_json` or `case_json`
    std::string table = {};
    std::vector<Picture> pictures = {};  ///< for readers without scripts; of a line for all where uPlot is missing
};

struct TradePart {
    std::string shape;
    Json json;  ///< of `trade_json`
    std::string words;
    std::vector<Picture> pictures;
};

/// What is chosen for a scene by a wish. Its times differ from run to run.
struct ChoicePart {
    std::string scene, wish;  ///< its id; `18 correct bits of every hit, no wrong decision`
    std::string words;
    std::string table;  ///< HTML, see `choice_table`
    Picture front;
};

/// What a form is mended to for a scene and a wish.
struct MendPart {
    std::string form, scene, wish;     ///< `sphere.half_b in f32`; the scene's id
    std::vector<std::string> changes;  ///< a sentence for each form that came out
    std::string words;                 ///< of `mend::in_words`
    std::string table;                 ///< HTML, see `mend_table`
    Picture front;
    bool timed = false;  ///< its times differ from run to run
};

/// What becomes of rays that leave the points of a scene, by every strategy.
struct OffsetPart {
    std::string id, title, note, source;
    std::vector<std::string> words = {};
    std::vector<std::string> strategies = {};
    std::array<std::vector<double>, 2> bad = {};  ///< of a side: the share of rays that go wrong, a strategy each
    std::string table = {};                       ///< HTML, see `offset_table`
    Picture sheet = {};
};

struct Report {
    std::string command;  ///< what to type to make the page again
    std::vector<MapPart> maps;
    std::vector<SweepPart> sweeps;
    std::vector<TradePart> trades;
    std::vector<ChoicePart> choices = {};
    std::vector<MendPart> mends = {};
    std::vector<OffsetPart> offsets = {};
    std::vector<scene::claim::Claim> claims;
    std::vector<measure::claim::ClaimResult> results;
    std::string processor = {};  ///< that the times are of; empty where nothing tells
    std::string program = {};    ///< that made it: `lostbits 0.1.0`
};

/// Forms and formats of a map: decisions, and p50, p99 and max of lost bits, withheld where too few hits agree; each
/// number carries the CSV's own decimal.
[[nodiscard]] std::string summary_table(const measure::evaluate::EvaluationRequest& request,
                                        const std::vector<measure::evaluate::FormSummary>& summaries);

/// Every form and format, cheapest first: time, bits kept, wrong decisions, whether it meets the wish.
[[nodiscard]] std::string choice_table(const choice::Chosen& chosen);

/// The form, what came of it and the best of the catalogue: wider operations, bits kept and wrong decisions here and on
/// rays on which nothing was searched, times if there are any; each number carries the CSV's own decimal.
[[nodiscard]] std::string mend_table(const mend::MendResult& result);

/// A table a side: what share of the rays each strategy gets wrong and how, and how much too large it is.
[[nodiscard]] std::string offset_table(const measure::offset::OffsetRequest& request,
                                       const measure::offset::OffsetSummary& summary);

/// A table a side: strategies down, scenes across, the share of rays that go wrong.
[[nodiscard]] std::string offset_overview(const std::vector<OffsetPart>& parts);

/// The counts as tiles, the gravest first to be seen.
[[nodiscard]] std::string verdict_tiles(const claim::VerdictCounts& counts);
/// A table per subject, with a row per claim; where the page shows what it was measured on, its place is a link to it.
[[nodiscard]] std::string claims_table(const Report& report);

/// The page, the same bytes for the same report.
[[nodiscard]] std::string page(const Report& report);

}  // namespace lostbits::output::page
