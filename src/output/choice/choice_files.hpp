// The files of a choice: choose.csv (every form and format, cheapest first), room.csv, offset.csv, inputs.csv,
// requirement.csv, requirement.png, front.png, choose.txt and datapackage.json. Times are measured and differ from run
// to run; the columns of accuracy do not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/choice/choice_text.hpp"
#include "output/speed/trade_files.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::choice {

/// Every form and format by time and bits kept, with the Pareto front and what is chosen.
void write_front_plot(const std::filesystem::path& path, const Chosen& chosen);

/// A row of choose.csv: a candidate, or the answers of the files.
struct CandidateRow {
    speed::KernelName name;
    const measure::speed::Timing* time;  ///< null: it is not known
    const measure::choice::Worth* worth;
    bool meets, chosen;
    const MendedCandidate* mended;  ///< null: it is a form as it is
};
table::Table<CandidateRow> candidate_table();
/// Cheapest first.
std::vector<CandidateRow> candidate_rows(const Chosen& chosen);

/// rays, true_hits, wrong, wrong_fraction and kept_bits.
table::Table<measure::choice::Worth> worth_columns();

/// The columns of room.csv.
table::Table<measure::choice::Room> room_table();

/// A strategy that is safe to one side or to both.
struct SafeOffsetRow {
    std::string_view side;
    measure::offset::SafeStrategy safe;
};

/// A choice of inputs that come wider.
struct InputRow {
    const measure::choice::Obstacle* obstacle;
    const measure::choice::InputTrial* trial;
};

struct RequirementRow {
    std::string_view form, format;
    file::Cell time_ns;
    std::uint64_t met, required, pixels;
};
table::Table<RequirementRow> requirement_table();
/// A row per form and format with a pixel to its name or a time, cheapest first; then one per format under `any`, and
/// one for the pixels on which nothing meets the wish.
std::vector<RequirementRow> requirement_rows(const Chosen& chosen, const measure::choice::Requirement& requirement);
/// Left the cheapest that meets the wish, right the narrowest format in which any form does; pixel by pixel.
void draw_requirement(const std::filesystem::path& path, const Chosen& chosen,
                      const measure::choice::Requirement& requirement);

/// Opened before the work, named when it is whole.
class ChoiceFiles {
public:
    explicit ChoiceFiles(const std::filesystem::path& folder);
    void finish(const Chosen& chosen);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<CandidateRow> candidates_;
    table::TableFile<measure::choice::Room> rooms_;
    table::TableFile<SafeOffsetRow> offsets_;
    table::TableFile<InputRow> inputs_;
    table::TableFile<RequirementRow> requirement_;
};

}  // namespace lostbits::output::choice
