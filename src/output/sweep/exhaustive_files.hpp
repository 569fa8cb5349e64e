// The files of an exhaustive sweep: binades.csv, onsets.csv, statements.csv, pictures and datapackage.json.
#pragma once

#include <filesystem>

#include "measure/sweep/exhaustive_findings.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::sweep {

/// Opens the tables before the work and gives them their final names in `finish`.
class ExhaustiveFiles {
public:
    ExhaustiveFiles(const measure::sweep::ExhaustiveRequest& request, const std::filesystem::path& folder);
    void finish(const measure::sweep::ExhaustiveState& state,
                const std::vector<measure::sweep::RangeFinding>& findings);

private:
    void write_binades(const measure::sweep::ExhaustiveState& state);
    void write_onsets(const measure::sweep::RangeFinding& finding);
    void write_statement(const measure::sweep::RangeFinding& finding);

    const measure::sweep::ExhaustiveRequest& request_;
    std::filesystem::path folder_;
    file::CsvWriter binades_, onsets_, statements_;
};

}  // namespace lostbits::output::sweep
