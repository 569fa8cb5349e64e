// The files of a sweep: samples.csv, onsets.csv and datapackage.json.
#pragma once

#include <filesystem>

#include "measure/sweep.hpp"
#include "output/csv.hpp"

namespace lostbits::output {

/// Opens the tables before the work and gives them their final names in `finish`.
class SweepFiles {
public:
    SweepFiles(const SweepRequest& request, const std::filesystem::path& folder);
    void finish(const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets);

private:
    const SweepRequest& request_;
    std::filesystem::path folder_;
    CsvWriter samples_, onsets_;
};

}  // namespace lostbits::output
