// Lists the numbers of a summary, one `SummaryColumn` each. A number is a column of summary.csv, samples.csv and
// cases.csv, a quantity that claims can name, and a value for the tables of a report's page.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

struct SummaryColumn {
    /// How files write the number. A `category` is an index into `categories`; files write the name at this index.
    enum class Kind { count, number, hex, category };

    std::string name;
    Kind kind;
    std::string unit, meaning;
    std::function<double(const FormSummary&)> value;  ///< NaN if there is no value
    std::span<const std::string_view> categories = {};
    bool is_in_tables = true;      ///< false: only in claims
    bool only_for_meshes = false;  ///< in tables only if there are meshes
};

/// Counts and fractions of outcomes, then mean, p50, p99 and max of |metric|, or the counts of its categories.
std::vector<SummaryColumn> make_summary_columns(const std::vector<const metric::Metric*>& metrics);

/// The worst ray by |ulp_error|, with all numbers for evaluating it again. `shapes` are those of the primitives, each
/// once: they name the columns of the worst ray's primitive.
std::vector<SummaryColumn> make_worst_columns(const std::vector<Shape>& shapes);

/// The first ray of the most frequent wrong decision: the form's answer and the truth.
std::vector<SummaryColumn> make_wrong_decision_columns();

/// `contribution_c` for `contribution:c`; with a statistic, `contribution_c_p50`.
std::string column_name(const metric::Metric& metric);
std::string column_name(const metric::Metric& metric, const metric::Statistic& statistic);

/// The column with that name; null if the table has no such column.
const SummaryColumn* find_column(const std::vector<SummaryColumn>& columns, std::string_view name);

}  // namespace lostbits::measure::evaluate
