// Interface through which claims use studies. The list of studies is above this folder (analysis/study), so a run
// passes it in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::claim {

/// A study of a scene with some rows.
struct StudyQuestion {
    const scene::file::Scene& scene;
    std::vector<evaluate::TestedForm> rows;
    std::map<std::string, std::vector<std::string>> options = {};  ///< by name; other options have their default values
    std::set<std::string> columns = {};                            ///< names of the requested numbers of the summary
    intersect::process::StopToken stop = {};
};

/// A row of the summary of a study.
struct StudyRow {
    std::map<std::string, std::string> words;                  ///< by column; form and format are columns too
    std::map<std::string, double> numbers;                     ///< by column; NaN if missing
    std::map<std::string, evaluate::WorstRay> witnesses = {};  ///< by requested column
    std::uint64_t unproved = 0;                                ///< number of its pixels without a proof
};

/// Names of a study that a claim can use.
struct StudyNames {
    std::vector<std::string> options, words, numbers;  ///< words and numbers are columns of the summary
};

class ClaimStudies {
public:
    virtual ~ClaimStudies() = default;
    /// Throws InputError for an unknown study.
    [[nodiscard]] virtual StudyNames names(const std::string& study) const = 0;
    /// Throws InputError if the study does not take the scene, a form or the value of an option.
    [[nodiscard]] virtual std::vector<StudyRow> measure(const std::string& study, const StudyQuestion& asked) const = 0;
    /// Draws the sheet of a study. Throws as `measure`.
    virtual void draw(const std::string& study, const StudyQuestion& asked,
                      const std::filesystem::path& file) const = 0;
};

}  // namespace lostbits::measure::claim
