// Parts shared by the comparison of tables and of pictures: judging two values, and recording the result.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "output/diff/difference.hpp"

namespace lostbits::output::diff {

/// Verdict on two cells or samples.
struct PairVerdict {
    bool differs = false;
    bool is_not_finite = false;  ///< at least one of the two is not a finite number
    bool has_distances = false;  ///< both are finite numbers, and `absolute` and `relative` are their distances
    double absolute = 0, relative = 0;
};

/// Compares the decimals of two cells exactly. With `as_text`, any difference of their texts counts.
PairVerdict judge_cells(std::string_view a, std::string_view b, const Tolerance* tolerance, bool as_text);
/// A cell as a double; NaN if it is not a finite number.
double cell_number(std::string_view cell);
/// Compares two samples. `tolerance` is the absolute and the relative one.
PairVerdict judge_samples(float a, float b, const std::optional<std::pair<double, double>>& tolerance);

/// ` (abs …, rel …)` if the distances were measured.
std::string distances_text(const PairVerdict& verdict);

/// Tolerance of a column or channel: the last tolerance that names it; null if none does.
const Tolerance* tolerance_of(const std::string& name, const CompareOptions& options);
bool is_ignored(const CompareOptions& options, const std::string& name);

/// Quotes text for a message, and escapes what would break the line or the terminal.
std::string escape_and_quote(std::string_view text);

/// Collects the differences of a comparison.
struct Ledger {
    const CompareOptions& options;
    Comparison result;

    /// Counts a difference, and keeps its text while fewer than `options.max_listed` are kept. `line` is the line of
    /// the difference in the first file; 0 if it has no line there, as in pictures.
    void add(std::size_t line, const auto& make_text) {
        if (result.count++ < options.max_listed) result.differences.push_back({line, make_text()});
    }
};

/// Records a verdict in its column. Returns true if the two values differ.
inline bool record_verdict(ColumnDifference& column, const PairVerdict& verdict, const auto& make_position) {
    column.count += verdict.differs;
    column.not_finite_count += verdict.differs && verdict.is_not_finite;
    const auto raise = [&](LargestDifference& largest, double value) {
        if (largest.position.empty() || value > largest.value) largest = {value, make_position()};
    };
    if (verdict.has_distances && (verdict.differs || verdict.absolute > 0)) {
        raise(column.absolute, verdict.absolute);
        raise(column.relative, verdict.relative);
    }
    return verdict.differs;
}

}  // namespace lostbits::output::diff
