// The columns of a summary: a row of this table is a column of summary.csv, samples.csv and cases.csv, a number that a
// claim may be about, and what the page shows.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

struct SummaryColumn {
    /// How the number is written; of `category` as the name at that place of `categories`.
    enum class Kind { count, number, hex, category };

    std::string name;
    Kind kind;
    std::string unit, meaning;
    std::function<double(const FormSummary&)> value;  ///< NaN where it is missing
    std::span<const std::string_view> categories = {};
    bool tabled = true;      ///< false: for claims alone
    bool of_meshes = false;  ///< tabled where there are meshes
};

/// Counts and fractions of outcomes, then mean, p50, p99 and max of |metric|, or the counts of its categories.
std::vector<SummaryColumn> summary_columns(const std::vector<const metric::Metric*>& metrics);

/// The worst ray by |ulp_error|, with every number it takes to evaluate it again. `shapes` are those of the solids,
/// each once: they name the columns of the worst ray's solid.
std::vector<SummaryColumn> worst_columns(const std::vector<Shape>& shapes);

/// The first ray of the most frequent wrong decision: what the form said there, and what is true.
std::vector<SummaryColumn> fault_columns();

/// `contribution_c` of `contribution:c`; with a statistic, `contribution_c_p50`.
std::string column_name(const metric::Metric& metric);
std::string column_name(const metric::Metric& metric, const metric::Statistic& statistic);

/// The column of that name; null where there is none.
const SummaryColumn* find_column(const std::vector<SummaryColumn>& columns, std::string_view name);

}  // namespace lostbits::measure::evaluate
