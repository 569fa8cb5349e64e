// Files of a sweep: samples.csv, onsets.csv (for one axis), culprits.csv (if culprits are measured) and
// datapackage.json.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/sweep.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::sweep {

using measure::sweep::Onset;
using measure::sweep::SweepRequest;
using measure::sweep::SweepStep;

/// A row of results for a form, or for one of its culprits, at a step of the sweep.
template <class Row>
struct StepRow {
    const SweepStep* step;
    Row row;
};
using SampleRow = StepRow<map::SummaryRow>;

/// Columns and rows of samples.csv, and columns of onsets.csv.
table::Table<SampleRow> sample_table(const SweepRequest& request);
std::vector<SampleRow> sample_rows(const SweepRequest& request, const std::vector<SweepStep>& steps);
table::Table<Onset> make_onset_table(const SweepRequest& request);

/// Files of a sweep. The tables are opened before the work and get their final names in `finish`.
class SweepWriter {
public:
    SweepWriter(const SweepRequest& request, const std::filesystem::path& folder);
    /// Throws InputError if an axis has the name of another column. Call it before the work.
    static void require_own_columns(const SweepRequest& request);
    void finish(const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets);

private:
    const SweepRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<SampleRow> samples_;
    std::optional<table::TableFile<Onset>> onsets_;  ///< for a sweep with one axis
    std::optional<table::TableFile<StepRow<map::Culprit>>> culprits_;
};

}  // namespace lostbits::output::sweep
