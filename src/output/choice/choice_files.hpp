// The files of a choice: choose.csv (every form and format, cheapest first), room.csv, offset.csv, inputs.csv,
// requirement.csv, requirement.png, front.png, choose.txt and datapackage.json. Times are measured and differ from run
// to run; the columns of accuracy do not.
#pragma once

#include <filesystem>

#include "output/choice/choice_text.hpp"
#include "output/choice/other_tables.hpp"
#include "output/choice/requirement_files.hpp"
#include "output/speed/kernel_rows.hpp"
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
