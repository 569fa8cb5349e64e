// The files of a sweep: samples.csv, onsets.csv (of a sweep with one axis), culprits.csv (where asked for) and datapackage.json.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/sweep.hpp"
#include "output/file/csv.hpp"
#include "output/map/culprit_table.hpp"

namespace lostbits::output {

/// Opens the tables before the work and gives them their final names in `finish`.
class SweepFiles {
public:
    SweepFiles(const SweepRequest& request, const std::filesystem::path& folder);
    void finish(const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets);

private:
    void write_onsets(const std::vector<Onset>& onsets);

    const SweepRequest& request_;
    std::filesystem::path folder_;
    CsvWriter samples_;
    std::optional<CsvWriter> onsets_;  ///< of a sweep with one axis
    std::optional<CulpritTable> culprits_;
};

}  // namespace lostbits::output
