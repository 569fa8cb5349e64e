// Text and files of a choice: which form and format meets the requirement, what it costs and assumes, and how far the
// scene can change before it fails. The files are:
// - choose.csv: every form and format, cheapest first; choose.txt: the answer in words
// - room.csv: how far the scene can change; offset.csv: safe strategies for the next ray
// - inputs.csv: if nothing meets the requirement, what wider inputs would give
// - requirement.csv and requirement.png: the cheapest form and the narrowest format of each pixel
// - front.png: the Pareto front of time and kept bits; datapackage.json
// Times are measured and differ from run to run; the columns of accuracy do not.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "measure/choose/candidates.hpp"
#include "measure/choose/margin.hpp"
#include "measure/choose/obstacle.hpp"
#include "measure/choose/requirement_map.hpp"
#include "output/table/table.hpp"
#include "output/trade/trade_files.hpp"

namespace lostbits::output::choose {

using measure::choose::Candidate;
using measure::choose::FormQuality;
using measure::choose::GrowthMargin;
using measure::choose::Obstacle;
using measure::choose::Requirement;
using measure::choose::RequirementMap;

/// A candidate made by repairing a form (`lostbits mend`) that does not meet the requirement.
struct RepairedCandidate {
    std::string name;              ///< name of the candidate's form
    std::string method;            ///< `sphere.half_b, 3 of its 20 operations in double: c, disc`
    FormQuality held_out_quality;  ///< on rays of the scene that the search did not use
    std::string file;              ///< C++ file of the form
};

/// All results of a choice.
struct ChoiceResult {
    const measure::choose::ChoiceRequest& request;
    const std::vector<Candidate>& candidates;
    measure::choose::TimedRays timed;
    std::optional<std::size_t> cheapest_index;  ///< index of the cheapest candidate that meets the requirement
    std::vector<GrowthMargin> margins = {};     ///< margins of the chosen candidate
    std::optional<measure::choose::SafeOffsets> offsets = {};     ///< safe offsets of the chosen candidate, if measured
    std::optional<Obstacle> obstacle = {};                        ///< set if nothing meets the requirement
    std::optional<RequirementMap> requirement_map = {};           ///< what each pixel of a scene requires
    std::optional<std::vector<RepairedCandidate>> repaired = {};  ///< repaired candidates, if a repair was requested

    /// The repair behind a candidate; null for a candidate that is a form as it is.
    [[nodiscard]] const RepairedCandidate* repair_of(std::string_view form) const {
        if (!repaired) return nullptr;
        const auto found = std::ranges::find(*repaired, form, &RepairedCandidate::name);
        return found == repaired->end() ? nullptr : &*found;
    }
};

/// Chooses among measured candidates. Also measures the margins of the chosen one, or finds the obstacle if no
/// candidate meets the requirement. Calls neither `request.show` nor `request.progress`. The arguments must outlive
/// the result.
ChoiceResult choose_among(const measure::choose::ChoiceRequest& request, const std::vector<Candidate>& candidates,
                          measure::choose::TimedRays timed);

/// Kept bits to one decimal, or to as many decimals as show on which side of the requirement they lie: 15.96 if 16 are
/// required.
std::string kept_bits_text(double kept_bits, const Requirement& requirement);
/// `, 0.0012 off`, with enough digits to tell the distance error from the tolerance of the requirement; empty if the
/// requirement has no tolerance.
std::string distance_error_text(double distance_error, const Requirement& requirement);

/// The requirement in words: `16 bits of 99 of 100 hits, no wrong decision`.
std::string requirement_text(const Requirement& requirement);
/// The answer of the choice, in several lines. All times are of this run.
std::string choice_text(const ChoiceResult& result);
/// The formats that the pixels need, and the least cost of switching between forms; two or three lines.
std::string requirement_map_text(const ChoiceResult& result, const RequirementMap& requirement_map);
/// Lines on the obstacle, that is, on what keeps every candidate from meeting the requirement. Each line begins with
/// two blanks. `nearest` is the candidate that comes nearest to the requirement.
std::string obstacle_text(const ChoiceResult& result, const Candidate& nearest);
/// Reason why a margin ends, such as `; beyond that no ray hits anything`. The text is `failure_text` if the margin
/// ends because the requirement fails.
std::string margin_end_text(const GrowthMargin& margin, const measure::choose::FileRays* rays,
                            const std::string& failure_text);
/// Name of a format of inputs: `binary32`, `binary64`, `p31`.
std::string input_format_name(const FloatFormat& format);

/// Plots every form and format by time and bits kept, with the Pareto front and the chosen one.
image::Canvas draw_pareto_plot(const ChoiceResult& result);

/// A row of choose.csv: a candidate, or the answers of the files.
struct CandidateRow {
    trade::KernelKey kernel;
    const measure::trade::Timing* time;  ///< null: unknown
    const FormQuality* quality;
    bool meets_requirement, is_chosen;
    const RepairedCandidate* repair;  ///< null: the form was not repaired
};
table::Table<CandidateRow> make_candidate_table();
/// The rows of choose.csv, cheapest first.
std::vector<CandidateRow> make_candidate_rows(const ChoiceResult& result);

/// The columns rays, true_hits, wrong, wrong_fraction and kept_bits.
table::Table<FormQuality> make_quality_columns();

/// The columns of room.csv.
table::Table<GrowthMargin> make_margin_table();

/// A row of offset.csv: a strategy that is safe for one side or for both.
struct SafeOffsetRow {
    std::string_view side;
    measure::offset::SafeStrategy strategy;
};

/// A row of inputs.csv: a selection of inputs in a wider format.
struct InputRow {
    const Obstacle* obstacle;
    const measure::choose::InputTrial* trial;
};

/// A row of requirement.csv. `met` and `required` count pixels; see `make_requirement_table` for their meanings.
struct RequirementRow {
    std::string_view form, format;
    std::optional<double> time_ns;
    std::uint64_t met, required, pixels;
};
table::Table<RequirementRow> make_requirement_table();
/// A row for each form and format that a pixel requires or that has a time, cheapest first; then one per format under
/// `any`, and one for the pixels on which nothing meets the requirement.
std::vector<RequirementRow> make_requirement_rows(const ChoiceResult& result, const RequirementMap& requirement_map);
/// Draws the scene twice, pixel by pixel: on the left the cheapest candidate that meets the requirement there, on the
/// right the narrowest format in which any form does.
void draw_requirement_map(const std::filesystem::path& path, const ChoiceResult& result,
                          const RequirementMap& requirement_map);

/// Files of a choice. They are opened before the measurement and get their final names when they are complete.
class ChoiceWriter {
public:
    explicit ChoiceWriter(const std::filesystem::path& folder);
    void finish(const ChoiceResult& result);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<CandidateRow> candidates_;
    table::TableFile<GrowthMargin> margins_;
    table::TableFile<SafeOffsetRow> offsets_;
    table::TableFile<InputRow> inputs_;
    table::TableFile<RequirementRow> requirement_;
};

}  // namespace lostbits::output::choose
