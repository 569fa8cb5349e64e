// Claims: sentences with a citation, a measurement and an expectation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/toml_tree.hpp"

namespace lostbits::scene {

struct Claim {
    enum class Verdict { holds, refuted };
    enum class Severity { error, warn };

    std::string id, statement, source, note;
    Verdict verdict = Verdict::holds;  ///< what was found; either way the measurement must lie in `low`..`high`
    Severity severity = Severity::error;
    Where where;  ///< of the claim, for messages

    // given: one scene, or one sweep and perhaps one place on its axis
    std::string scene, sweep, form, format;
    std::optional<double> at;

    // expect: a column of the summary, or an onset along the sweep
    std::string metric;
    std::string onset, statistic;  ///< event and statistic of `onsets.csv`
    double threshold = 0;
    double low = 0, high = 0;  ///< both ends count
};

/// All claims of a file. InputError with a position for anything that is no claim; an id given twice is one.
std::vector<Claim> read_claims(const std::filesystem::path& path);

/// All `*.toml` of a folder, sorted, or the file itself.
std::vector<std::filesystem::path> claim_files(const std::filesystem::path& file_or_folder);

}  // namespace lostbits::scene
