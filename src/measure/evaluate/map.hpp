// Maps: every form in every format on the ray of each pixel of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "measure/evaluate/measure_form.hpp"
#include "measure/study/study.hpp"

namespace lostbits::measure::evaluate {

/// Rows with the same ray generator; null: rays as the scene makes them.
struct FormsOfGenerator {
    const scene::camera::RayGenerator* generator;
    std::vector<std::size_t> form_indices;  ///< indices in the list of all tested forms
};
std::vector<FormsOfGenerator> group_by_generator(const std::vector<TestedForm>& tested_forms);

/// The map of a scene, as a study (measure/study/study.hpp).
struct MapStudy {
    using Band = BandResult;
    using Summary = FormSummary;
    static constexpr int pixels_per_band = study::default_pixels_per_band;

    const scene::file::Scene* scene = nullptr;
    std::vector<TestedForm> tested_forms;
    std::vector<const metric::Metric*> metrics;
    truth::ProofLimit limit{};
    /// Receives the number of truths that each stage settled; may be null.
    truth::StageCounts* stages = nullptr;
    shard::Share share = {};
    /// Called after each band with the number of (pixel, row) pairs done; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    static void require() {}
    /// The scene, or the scene with the rays of a generator, for each generator among the forms.
    [[nodiscard]] std::vector<study::FormsOfScene> scenes() const;
    [[nodiscard]] FormSummary begin(std::size_t) const { return FormSummary(metrics); }
    [[nodiscard]] SharedBandTruth prepare(truth::Band& band, const std::vector<std::size_t>& form_indices) const;
    void measure(const SharedBandTruth& shared, std::size_t form_index, FormSummary& summary, const Show& show) const;
};

/// Measures a map, or the share of one. The distributions are not sealed: a requirement may ask for any quantile.
std::vector<FormSummary> run_map(const MapStudy& map, const ShowForms& show = {});

}  // namespace lostbits::measure::evaluate
