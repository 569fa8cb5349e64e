// The files of a choice: choose.csv (every form and format, cheapest first), room.csv, offset.csv, inputs.csv,
// requirement.csv, requirement.png, front.png, choose.txt and datapackage.json. Times are measured and differ from run
// to run; the columns of accuracy do not.
#pragma once

#include <filesystem>

#include "output/choice/choice_text.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::choice {

/// Every form and format by time and bits kept, with the Pareto front and what is chosen.
void write_front_plot(const std::filesystem::path& path, const Chosen& chosen);

/// The columns and rows of choose.csv and of room.csv.
std::vector<file::Column> candidate_columns();
void add_candidates(file::CsvWriter& csv, const Chosen& chosen);
std::vector<file::Column> room_columns();
void add_rooms(file::CsvWriter& csv, const Chosen& chosen);

/// Opened before the work, named when it is whole.
class ChoiceFiles {
public:
    explicit ChoiceFiles(const std::filesystem::path& folder);
    void finish(const Chosen& chosen);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    file::CsvWriter candidates_, rooms_, offsets_, inputs_, requirement_;
};

}  // namespace lostbits::output::choice
