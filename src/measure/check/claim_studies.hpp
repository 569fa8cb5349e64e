// Interface through which claims use studies. The list of studies is in analysis/study, which this folder may not
// include, so the caller passes an implementation.
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

namespace lostbits::measure::check {

/// A study to run on a scene, with the rows to measure.
struct StudyQuestion {
    const scene::file::Scene& scene;
    std::vector<evaluate::TestedForm> tested_forms;
    std::map<std::string, std::vector<std::string>> options = {};  ///< by name; other options have their default values
    std::set<std::string> columns = {};                            ///< names of the requested numbers of the summary
    intersect::process::StopToken stop = {};
};

/// A row of the summary of a study.
struct StudyRow {
    std::map<std::string, std::string> texts;                  ///< by column; form and format are columns too
    std::map<std::string, double> numbers;                     ///< by column; NaN if missing
    std::map<std::string, evaluate::WorstRay> witnesses = {};  ///< by requested column
    std::uint64_t unproved_count = 0;                          ///< number of pixels whose truth is not proved
};

/// Names of a study that a claim can use.
struct StudyNames {
    std::vector<std::string> options, text_columns, number_columns;  ///< the columns are those of the summary
};

/// Studies by name.
class ClaimStudies {
public:
    virtual ~ClaimStudies() = default;
    /// Names of a study that a claim can use. Throws InputError for an unknown study.
    [[nodiscard]] virtual StudyNames allowed_names(const std::string& study) const = 0;
    /// Rows of the summary of a study. Throws InputError if the study does not take the scene, a form or the value of
    /// an option.
    [[nodiscard]] virtual std::vector<StudyRow> measure(const std::string& study,
                                                        const StudyQuestion& question) const = 0;
    /// Draws the contact sheet of a study into `file`. Throws as `measure` does.
    virtual void draw(const std::string& study, const StudyQuestion& question,
                      const std::filesystem::path& file) const = 0;
};

}  // namespace lostbits::measure::check
