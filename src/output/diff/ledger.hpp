// Parts shared by the comparison of tables and of pictures: judging two values, and recording the result.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "output/diff/difference.hpp"

namespace lostbits::output::diff {

/// Relation of two cells or samples that are not the same.
struct PairVerdict {
    bool differs = false;
    bool not_finite = false;  ///< at least one of them is not a finite number
    bool measured = false;    ///< both are finite numbers, and these are their distances
    double absolute = 0, relative = 0;
};

/// Compares decimals exactly. `as_text`: any difference of the text counts.
PairVerdict judge_cells(std::string_view a, std::string_view b, const Tolerance* tolerance, bool as_text);
/// A cell as a double; NaN if it is not a finite number.
double number_in(std::string_view cell);
/// `tolerance` is absolute and relative.
PairVerdict judge_samples(float a, float b, const std::optional<std::pair<double, double>>& tolerance);

/// ` (abs …, rel …)` if the distances were measured.
std::string distances(const PairVerdict& v);

/// Tolerance of a column or channel: the last one that names it; null if none does.
const Tolerance* tolerance_of(const std::string& name, const CompareOptions& options);
bool ignores(const CompareOptions& options, const std::string& name);

/// Quotes text for a message, and escapes what would break the line or the terminal.
std::string in_quotes(std::string_view text);

/// Collects differences.
struct Ledger {
    const CompareOptions& options;
    Comparison result;

    /// Counts a difference, and keeps its text while fewer than `options.most` are kept. `line` is its line in the
    /// first file; 0 if it has none there, as in pictures.
    void add(std::size_t line, const auto& make_text) {
        if (result.count++ < options.most) result.differences.push_back({line, make_text()});
    }
};

/// Records a verdict under its column; returns true if it is a difference.
inline bool record_verdict(ColumnDifference& column, const PairVerdict& v, const auto& make_place) {
    column.count += v.differs;
    column.not_finite += v.differs && v.not_finite;
    const auto raise = [&](Largest& largest, double value) {
        if (largest.at.empty() || value > largest.value) largest = {value, make_place()};
    };
    if (v.measured && (v.differs || v.absolute > 0)) {
        raise(column.absolute, v.absolute);
        raise(column.relative, v.relative);
    }
    return v.differs;
}

}  // namespace lostbits::output::diff
