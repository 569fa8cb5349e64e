// Files of a sweep: samples.csv, onsets.csv (for one axis), culprits.csv (if asked for) and datapackage.json.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/sweep.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::sweep {

/// Results of a row, or of one of its culprits, at a step.
template <class Known>
struct AtStep {
    const measure::sweep::SweepStep* step;
    Known known;
};
using SampleRow = AtStep<map::SummaryRow>;

/// Columns and rows of samples.csv, and columns of onsets.csv.
table::Table<SampleRow> sample_table(const measure::sweep::SweepRequest& request);
std::vector<SampleRow> sample_rows(const measure::sweep::SweepRequest& request,
                                   const std::vector<measure::sweep::SweepStep>& steps);
table::Table<measure::sweep::Onset> onset_table(const measure::sweep::SweepRequest& request);

/// Opens the tables before the work and gives them their final names in `finish`.
class SweepFiles {
public:
    SweepFiles(const measure::sweep::SweepRequest& request, const std::filesystem::path& folder);
    /// Throws InputError if an axis has the name of another column. Call it before the work.
    static void require_own_columns(const measure::sweep::SweepRequest& request);
    void finish(const std::vector<measure::sweep::SweepStep>& steps, const std::vector<measure::sweep::Onset>& onsets);

private:
    const measure::sweep::SweepRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<SampleRow> samples_;
    std::optional<table::TableFile<measure::sweep::Onset>> onsets_;  ///< for a sweep with one axis
    std::optional<table::TableFile<AtStep<map::Culprit>>> culprits_;
};

}  // namespace lostbits::output::sweep
