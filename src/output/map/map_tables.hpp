// The tables of a map: summary.csv (a row per form and format), culprits.csv (a row per form, format and operation) and
// the CSV of the pixels of one row.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/evaluate/groups.hpp"
#include "measure/evaluate/summary_columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::map {

/// What comes after `lostbits explain` to name a ray of a summary: `near-benign --pixel 3,4`; empty where nothing does.
using NameOfRay = std::function<std::string(const measure::evaluate::WorstRay&)>;

/// A row of a map, or a group of its rays.
struct SummaryRow {
    measure::evaluate::TestedForm row;
    const measure::evaluate::FormSummary* summary;
    NameOfRay name_of_ray;
    file::Cell group = {};  ///< missing: all rays
};

/// What is known of a row of the map, as the columns of `measure::evaluate::summary_columns`, `worst_columns` and
/// `fault_columns`, the last two with the command that explains the ray. Empty where there is no sample.
///
/// `meshes`: the rays are at meshes, and have the outcomes of those. `by`: the column whose values rays are grouped by,
/// in front of the others; empty: none.
table::Table<SummaryRow> summary_table(const std::vector<const measure::metric::Metric*>& metrics,
                                       const std::vector<Shape>& shapes, bool meshes = false, std::string by = {});
/// Of all rays, and then of each of the groups. `row` is the `r`th of the run.
std::vector<SummaryRow> summary_rows(std::size_t r, const measure::evaluate::TestedForm& row,
                                     const measure::evaluate::FormSummary& summary,
                                     const measure::evaluate::Groups& groups, const NameOfRay& name_of_ray);

/// An operation that is the culprit of some rays: as columns of a summary, operations would differ from run to run.
struct Culprit {
    measure::evaluate::TestedForm row;
    std::string_view operation;
    std::uint64_t rays;
    double fraction;
};
table::Table<Culprit> culprit_table();

/// Only where `culprit` is among the metrics.
[[nodiscard]] bool asks_for_culprits(const std::vector<const measure::metric::Metric*>& metrics);

/// The most frequent first.
std::vector<Culprit> culprits_of(const std::vector<const measure::metric::Metric*>& metrics,
                                 const measure::evaluate::TestedForm& row,
                                 const measure::evaluate::FormSummary& summary);

/// The operations that are the culprit of any ray, by their categories, the most frequent first; of equals the first on
/// the tape.
std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts);

/// A ray of a band, as a row of the run answers it.
struct BandRay {
    const measure::evaluate::BandResult* result;
    std::size_t i;
    const measure::evaluate::TestedForm* row;

    [[nodiscard]] bool hit() const { return result->answers->hit[i] != 0; }
    [[nodiscard]] file::Cell t() const { return result->answers->t[i]; }
};
/// outcome.
table::TableColumn<BandRay> outcome_column();
/// truth and truth_hex, and a column of each metric.
table::Table<BandRay> found_columns(const std::vector<const measure::metric::Metric*>& metrics);
/// A row a pixel.
table::Table<BandRay> pixel_table(const std::vector<const measure::metric::Metric*>& metrics);

}  // namespace lostbits::output::map
