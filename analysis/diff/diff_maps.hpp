// What changed between two folders of results, or between two forms of one: rows, outcomes, largest changes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/diff/diff_files.hpp"
#include "intersect/process/stop_token.hpp"
#include "output/diff/row_changes.hpp"

namespace lostbits::analysis::diff {

/// Two sides of maps: folders, and perhaps a form on each side.
struct MapSides {
    std::filesystem::path a, b;
    std::string form_a, form_b;        ///< empty: every form with itself
    std::vector<std::string> formats;  ///< of what is drawn or held against each other; all if empty
    [[nodiscard]] bool are_forms() const { return !form_a.empty(); }
};

struct MapDifference {
    output::diff::RowChanges rows;
    std::vector<Result> others;              ///< files that are not tables of forms
    std::uint64_t tables = 0, pictures = 0;  ///< compared; left out
    [[nodiscard]] bool same() const;
};

/// Every file below; `pictures`: those too. NothingSelected where nothing is left to compare.
[[nodiscard]] MapDifference compare_maps(const MapSides& sides, const output::diff::CompareOptions& options,
                                         bool pictures);

/// The line that a difference ends with: in how many rows the second side is better, worse and the same.
void print_verdict(const output::diff::RowVerdict& verdict, const std::string& second);

/// The verdict comes last. `most` lines of each kind; `verbose`: all of them, and the differences of other files.
void print(const MapDifference& difference, const MapSides& sides, bool verbose);

/// A picture in `out` for each form and format of each map whose pixels both sides hold; their paths. InputError where
/// there is none.
std::vector<std::filesystem::path> draw_maps(const MapSides& sides, const std::filesystem::path& out,
                                             intersect::process::StopToken stop);

}  // namespace lostbits::analysis::diff
