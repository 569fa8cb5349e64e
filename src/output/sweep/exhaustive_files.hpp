// The files of an exhaustive sweep: binades.csv, onsets.csv, statements.csv, pictures and datapackage.json.
#pragma once

#include <filesystem>

#include "measure/sweep/exhaustive.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::sweep {

struct FloatsRow;
struct FloatEventRow;

/// Opens the tables before the work and gives them their final names in `finish`.
class ExhaustiveFiles {
public:
    ExhaustiveFiles(const measure::sweep::ExhaustiveRequest& request, const std::filesystem::path& folder);
    void finish(const measure::sweep::ExhaustiveState& state,
                const std::vector<measure::sweep::RangeFinding>& findings);

private:
    void add_binades(const measure::sweep::ExhaustiveState& state);
    void add_onsets(const measure::sweep::RangeFinding& finding);

    const measure::sweep::ExhaustiveRequest& request_;
    std::filesystem::path folder_;
    table::TableFile<FloatsRow> binades_, statements_;
    table::TableFile<FloatEventRow> onsets_;
};

}  // namespace lostbits::output::sweep
