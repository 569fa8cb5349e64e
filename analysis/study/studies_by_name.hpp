// Calls studies by their names, for code that is not written for one study: claims and the page of `lostbits report`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/study/study_values.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/check/claim_studies.hpp"
#include "output/report/page.hpp"

namespace lostbits::analysis::study {

/// All studies, in the form in which claims use them.
class StudiesByName final : public measure::check::ClaimStudies {
public:
    [[nodiscard]] measure::check::StudyNames allowed_names(const std::string& study) const override;
    [[nodiscard]] std::vector<measure::check::StudyRow> measure(
        const std::string& study, const measure::check::StudyQuestion& question) const override;
    void draw(const std::string& study, const measure::check::StudyQuestion& question,
              const std::filesystem::path& file) const override;
};

/// Names of all studies, in the order of `Studies` (studies.hpp).
[[nodiscard]] std::vector<std::string> study_names();

/// Measures a study of a scene for the page of `lostbits report`, with the usual options of the study. Empty lists of
/// forms and formats mean the usual ones. Returns nullopt if no form fits the study and the scene. Throws InputError
/// for an unknown study, and for a scene that the study does not take.
[[nodiscard]] std::optional<output::report::StudySection> measure_study_section(const std::string& study,
                                                                                const scene::file::Scene& scene,
                                                                                std::vector<std::string> forms,
                                                                                std::vector<std::string> formats,
                                                                                intersect::process::StopToken stop);

/// Measures the rays that leave the points of a scene, for the overview of offsets on the page. The first of the usual
/// forms that fits the scene computes the points. Returns nullopt if none of them fits.
[[nodiscard]] std::optional<output::report::StudySection> measure_offset_section(const scene::file::Scene& scene,
                                                                                 intersect::process::StopToken stop);

}  // namespace lostbits::analysis::study
