// Text and files of a choice: what meets the requirement, what it costs and assumes, and how far the scene can change
// before it fails. The files are choose.csv (every form and format, cheapest first), room.csv, offset.csv, inputs.csv,
// requirement.csv, requirement.png, front.png, choose.txt and datapackage.json. Times are measured and differ from run
// to run; the columns of accuracy do not.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "measure/choice/margin.hpp"
#include "measure/choice/obstacle.hpp"
#include "measure/choice/requirement_map.hpp"
#include "output/speed/trade_files.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::choice {

using measure::choice::Candidate;
using measure::choice::GrowthMargin;
using measure::choice::Obstacle;
using measure::choice::Requirement;
using measure::choice::RequirementMap;
using measure::choice::RowQuality;

/// A candidate made by repairing a form (`lostbits mend`) that does not meet the requirement.
struct RepairedCandidate {
    std::string name;     ///< name of the candidate's form
    std::string how;      ///< `sphere.half_b, 3 of its 20 operations in double: c, disc`
    RowQuality held_out;  ///< on rays of the scene that the search did not use
    std::string file;     ///< C++ file of the form
};

/// All results of a choice.
struct ChoiceResult {
    const measure::choice::ChoiceRequest& request;
    const std::vector<Candidate>& all;
    measure::choice::TimedRays timed;
    std::optional<std::size_t> cheapest_index;  ///< index of the cheapest candidate that meets the requirement
    std::vector<GrowthMargin> margins = {};     ///< margins of the chosen candidate
    std::optional<measure::choice::SafeOffsets> offsets = {};     ///< safe offsets of the chosen candidate, if measured
    std::optional<Obstacle> obstacle = {};                        ///< if nothing meets the requirement
    std::optional<RequirementMap> requirement_map = {};           ///< for each pixel of a scene
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
ChoiceResult choose_among(const measure::choice::ChoiceRequest& request,
                          const std::vector<measure::choice::Candidate>& all, measure::choice::TimedRays timed);

/// Bits to one decimal, or to as many decimals as show on which side of the requirement they are: 15.96 if 16 are
/// required.
std::string bits_text_near(double kept_bits, const Requirement& requirement);
/// `, 0.0012 off`, with enough digits to tell the distance error from the tolerance of the requirement; empty if the
/// requirement has no tolerance.
std::string off_text(double distance_error, const Requirement& requirement);

/// `16 bits of 99 of 100 hits, no wrong decision`.
std::string in_words(const Requirement& requirement);
/// The answer, in several lines. All times are of this run.
std::string in_words(const ChoiceResult& chosen);
/// The formats that the pixels need, and the least cost of switching between forms; two or three lines.
std::string in_words(const ChoiceResult& chosen, const RequirementMap& requirement_map);
/// Lines on the obstacle, each beginning with two blanks. `nearest` is the candidate that comes nearest to the
/// requirement.
std::string obstacle_text(const ChoiceResult& chosen, const Candidate& nearest);
/// Reason why a margin ends, such as `; beyond that no ray hits anything`. `broken` is the text if the requirement
/// fails.
std::string margin_end_text(const GrowthMargin& margin, const measure::choice::FileRays* rays,
                            const std::string& broken);
/// `binary32`, `binary64`, `p31`: name of a format of inputs.
std::string name_of_inputs(const FloatFormat& format);

/// Plots every form and format by time and bits kept, with the Pareto front and the chosen one.
image::Canvas pareto_plot(const ChoiceResult& chosen);

/// A row of choose.csv: a candidate, or the answers of the files.
struct CandidateRow {
    speed::KernelKey name;
    const measure::speed::Timing* time;  ///< null: unknown
    const RowQuality* quality;
    bool meets_requirement, chosen;
    const RepairedCandidate* repair;  ///< null: the form as it is
};
table::Table<CandidateRow> candidate_table();
/// The rows of choose.csv, cheapest first.
std::vector<CandidateRow> candidate_rows(const ChoiceResult& chosen);

/// The columns rays, true_hits, wrong, wrong_fraction and kept_bits.
table::Table<RowQuality> quality_columns();

/// The columns of room.csv.
table::Table<GrowthMargin> margin_table();

/// A strategy that is safe for one side or for both.
struct SafeOffsetRow {
    std::string_view side;
    measure::offset::SafeStrategy safe;
};

/// A selection of inputs in a wider format.
struct InputRow {
    const Obstacle* obstacle;
    const measure::choice::InputTrial* trial;
};

struct RequirementRow {
    std::string_view form, format;
    std::optional<double> time_ns;
    std::uint64_t met, required, pixels;
};
table::Table<RequirementRow> requirement_table();
/// A row for each form and format that a pixel requires or that has a time, cheapest first; then one per format under
/// `any`, and one for the pixels on which nothing meets the requirement.
std::vector<RequirementRow> requirement_rows(const ChoiceResult& chosen, const RequirementMap& requirement_map);
/// Draws a scene pixel by pixel: on the left the cheapest candidate that meets the requirement, on the right the
/// narrowest format in which any form does.
void draw_requirement_map(const std::filesystem::path& path, const ChoiceResult& chosen,
                          const RequirementMap& requirement_map);

/// Files of a choice. They are opened before the measurement and get their final names when they are complete.
class ChoiceFiles {
public:
    explicit ChoiceFiles(const std::filesystem::path& folder);
    void finish(const ChoiceResult& chosen);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<CandidateRow> candidates_;
    table::TableFile<GrowthMargin> margins_;
    table::TableFile<SafeOffsetRow> offsets_;
    table::TableFile<InputRow> inputs_;
    table::TableFile<RequirementRow> requirement_;
};

}  // namespace lostbits::output::choice
