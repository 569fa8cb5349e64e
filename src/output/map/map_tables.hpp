// The tables of a map: summary.csv (a row per form and format), culprits.csv (a row per form, format and operation) and
// the CSV of the pixels of one row.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "measure/evaluate/groups.hpp"
#include "measure/evaluate/summary_columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::map {

using measure::evaluate::BandResult;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

/// Arguments of `lostbits explain` that name a ray of a summary: `near-benign --pixel 3,4`; empty if the ray has none.
using RayArguments = std::function<std::string(const measure::evaluate::WorstRay&)>;

/// A row of summary.csv: a form in a format over all rays, or over a group of them.
struct SummaryRow {
    TestedForm tested_form;
    const FormSummary* summary;
    RayArguments ray_arguments;
    std::optional<std::string> group = {};  ///< missing: all rays
};

/// Columns of summary.csv: those of `measure::evaluate::summary_columns`, `make_worst_columns` and
/// `make_wrong_decision_columns`. The last two groups end with the command that explains the ray. A cell without a
/// sample is empty. If `has_meshes`, the rays are aimed at meshes and have the outcomes of meshes too. `group_column`
/// is the column whose values group the rays; it stands first. If it is empty, there are no groups.
table::Table<SummaryRow> make_summary_table(const std::vector<const Metric*>& metrics, const std::vector<Shape>& shapes,
                                            bool has_meshes = false, std::string group_column = {});
/// A row for all rays, then one for each group. `tested_form` is row `r` of the run.
std::vector<SummaryRow> make_summary_rows(std::size_t r, const TestedForm& tested_form, const FormSummary& summary,
                                          const measure::evaluate::Groups& groups, const RayArguments& ray_arguments);

/// An operation that is the culprit of some rays. Operations are rows and not columns, because columns would differ
/// from run to run.
struct Culprit {
    TestedForm tested_form;
    std::string_view operation;
    std::uint64_t rays;
    double fraction;
};
table::Table<Culprit> make_culprit_table();

/// True if the metric `culprit` is among the metrics.
[[nodiscard]] bool asks_for_culprits(const std::vector<const Metric*>& metrics);

/// The culprits of a row, the most frequent first.
std::vector<Culprit> find_culprits(const std::vector<const Metric*>& metrics, const TestedForm& tested_form,
                                   const FormSummary& summary);

/// Categories of the operations that are the culprit of any ray, the most frequent first; equally frequent operations
/// in the order of the tape.
std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts);

/// A ray of a band (consecutive rows of pixels), as answered by a form in a format.
struct BandRay {
    const BandResult* result;
    std::size_t i;
    const TestedForm* tested_form;

    [[nodiscard]] bool has_hit() const { return result->answers->hit[i] != 0; }
    [[nodiscard]] double t() const { return result->answers->t[i]; }
};
/// The column `outcome`.
table::TableColumn<BandRay> outcome_column();
/// The columns truth and truth_hex (the true t), and one for each metric.
table::Table<BandRay> make_truth_and_metric_columns(const std::vector<const Metric*>& metrics);
/// One row per pixel.
table::Table<BandRay> make_pixel_table(const std::vector<const Metric*>& metrics);

}  // namespace lostbits::output::map
