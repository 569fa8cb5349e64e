// The files of a sweep: samples.csv, onsets.csv (of a sweep with one axis), culprits.csv (where asked for) and
// datapackage.json.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/sweep.hpp"
#include "output/file/csv.hpp"
#include "output/map/culprit_table.hpp"

namespace lostbits::output::sweep {

/// The columns of samples.csv and of onsets.csv, and their rows.
std::vector<file::Column> sample_columns(const measure::sweep::SweepRequest& request);
std::vector<file::Column> onset_columns(const measure::sweep::SweepRequest& request);
void add_samples(file::CsvWriter& samples, const measure::sweep::SweepRequest& request,
                 const std::vector<measure::sweep::SweepStep>& steps);
void add_onsets(file::CsvWriter& table, const measure::sweep::SweepRequest& request,
                const std::vector<measure::sweep::Onset>& onsets);

/// Opens the tables before the work and gives them their final names in `finish`.
class SweepFiles {
public:
    SweepFiles(const measure::sweep::SweepRequest& request, const std::filesystem::path& folder);
    /// InputError where the name of an axis is that of another column: to be asked before the work.
    static void require_own_columns(const measure::sweep::SweepRequest& request);
    void finish(const std::vector<measure::sweep::SweepStep>& steps, const std::vector<measure::sweep::Onset>& onsets);

private:
    const measure::sweep::SweepRequest& request_;
    std::filesystem::path folder_;
    file::CsvWriter samples_;
    std::optional<file::CsvWriter> onsets_;  ///< of a sweep with one axis
    std::optional<map::CulpritTable> culprits_;
};

}  // namespace lostbits::output::sweep
