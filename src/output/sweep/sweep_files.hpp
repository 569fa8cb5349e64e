// The files of a sweep: samples.csv, onsets.csv (of a sweep with one axis), culprits.csv (where asked for) and
// datapackage.json.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/sweep.hpp"
#include "output/file/csv.hpp"
#include "output/map/culprit_table.hpp"

namespace lostbits::output::sweep {

/// Opens the tables before the work and gives them their final names in `finish`.
class SweepFiles {
public:
    SweepFiles(const measure::sweep::SweepRequest& request, const std::filesystem::path& folder);
    /// InputError where the name of an axis is that of another column: to be asked before the work.
    static void require_own_columns(const measure::sweep::SweepRequest& request);
    void finish(const std::vector<measure::sweep::SweepStep>& steps, const std::vector<measure::sweep::Onset>& onsets);

private:
    void write_onsets(const std::vector<measure::sweep::Onset>& onsets);

    const measure::sweep::SweepRequest& request_;
    std::filesystem::path folder_;
    file::CsvWriter samples_;
    std::optional<file::CsvWriter> onsets_;  ///< of a sweep with one axis
    std::optional<map::CulpritTable> culprits_;
};

}  // namespace lostbits::output::sweep
