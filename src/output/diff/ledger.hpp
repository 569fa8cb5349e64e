// What comparing tables and comparing pictures share: what two values have to do with each other, and the books of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "output/diff/difference.hpp"

namespace lostbits::output::diff {

/// What two cells or samples that are not the same have to do with each other.
struct PairVerdict {
    bool differs = false;
    bool kinds = false;     ///< they are not both finite numbers
    bool measured = false;  ///< they are, and these are their distances
    double absolute = 0, relative = 0;
};

/// Decimals are compared exactly; `as_text`: what is not the same text differs.
PairVerdict judge_cells(std::string_view a, std::string_view b, const Tolerance* tolerance, bool as_text);
/// A cell as a double; NaN where it is not a finite number.
double number_in(std::string_view cell);
/// `tolerance`: absolute and relative.
PairVerdict judge_samples(float a, float b, const std::optional<std::pair<double, double>>& tolerance);

/// ` (abs …, rel …)` where they were measured.
std::string distances(const PairVerdict& v);

/// The tolerance of a column or channel: the last that names it; null where none does.
const Tolerance* tolerance_of(const std::string& name, const CompareOptions& options);
bool ignores(const CompareOptions& options, const std::string& name);

/// Text in a message: in quotes, and whatever would break the line or the terminal escaped.
std::string in_quotes(std::string_view text);

/// Where differences are entered.
struct Ledger {
    const CompareOptions& options;
    Comparison result;

    void add(std::size_t line, const auto& make_text) {
        if (result.count++ < options.most) result.differences.push_back({line, make_text()});
    }
};

/// Books a verdict under its column; says whether it is a difference.
inline bool book(ColumnDifference& column, const PairVerdict& v, const auto& make_place) {
    column.count += v.differs;
    column.kinds += v.differs && v.kinds;
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
