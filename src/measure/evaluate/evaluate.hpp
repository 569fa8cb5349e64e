// Evaluates every selected form in every selected format on every ray of a scene, and compares it with one truth.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "measure/answer/answers.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::evaluate {

/// A form in a format, as a run tests it.
struct TestedForm {
    const intersect::table::Intersector* form;
    Format format;
    /// Touching convention by which the form is judged; absent: its own.
    std::optional<intersect::Touching> touching = {};

    /// Form to compare the answers with, which exists in the format; may be null.
    const intersect::table::Intersector* against = nullptr;

    [[nodiscard]] intersect::Convention convention() const { return form->info->convention(touching); }
    friend bool operator==(const TestedForm&, const TestedForm&) = default;
};

/// The forms of the tested forms, each once, in their order.
std::vector<const intersect::table::Intersector*> forms_of(const std::vector<TestedForm>& tested_forms);

/// A ray that a summary names, with all inputs for evaluating the form again.
struct WorstRay {
    std::int64_t x = -1;  ///< column of the pixel; for a ray of a list its index, which may be above 2^31
    int y = -1;
    int group = 0;  ///< index of its group of rays in a sweep or a case
    std::int64_t primitive_index =
        -1;             ///< the primitive that the form hit; if each ray has its own primitive, the ray's index
    double size = -1;   ///< |ulp_error|; 0 for a wrong decision
    Ray<double> ray{};  ///< in the format; for a form that takes unit directions it is normalised, so t is a distance
    Primitive<double> primitive{};
    double t = 0;
    answer::Outcome outcome = answer::Outcome::agree_hit;
    double ulps = truth::missing;   ///< (t − t*)/ulp(t*), signed; NaN unless both hit
    double truth = truth::missing;  ///< t*, correctly rounded to binary64; NaN if the ray truly misses
    std::optional<intersect::Touching> touching = {};
    /// The ray before rounding to the format, with the primitives that decide its outcome. Null for a pixel of a scene,
    /// and if there are too many primitives.
    std::shared_ptr<const scene::rays::RayGroup> given = {};
};

using answer::is_wrong, answer::wrong_decisions;

/// Summary of a tested form over the whole picture.
struct FormSummary {
    std::uint64_t ray_count = 0;
    std::uint64_t view_count = 1;  ///< number of groups of rays with primitives of their own: the independent samples,
                                   ///< since rays of one group depend on each other
    std::array<std::uint64_t, answer::outcome_names.size()> outcomes{};
    std::uint64_t true_hit_count = 0;           ///< rays that truly hit, whatever the form answers
    std::vector<metric::Distribution> metrics;  ///< in the order of the request's metrics
    /// For each metric with categories, the number of rays in each category; empty for other metrics.
    std::vector<std::vector<std::uint64_t>> categories;
    /// Correct hit with the largest |ulp_error|, the first if several are equal; x < 0: no hit is correct.
    WorstRay worst;
    /// The first ray with each of the `wrong_decisions`, in their order; null if the form never makes the decision.
    std::array<std::unique_ptr<WorstRay>, wrong_decisions.size()> faults;

    FormSummary() = default;
    explicit FormSummary(const std::vector<const metric::Metric*>& measured);
    /// Adds values to the distribution of metric m, or to the counts of its categories. Skips NaN.
    void add(std::size_t m, const metric::Metric& metric, std::span<const double> values);
    /// Adds the summary of further rays, which all come after the rays in this summary.
    void append(FormSummary&& next_rays);
    [[nodiscard]] std::uint64_t count(answer::Outcome o) const { return outcomes[static_cast<std::size_t>(o)]; }
    /// Number of rays with any of the `wrong_decisions`.
    [[nodiscard]] std::uint64_t wrong_count() const;
    /// The most frequent of the `wrong_decisions`; nothing if every decision is right.
    [[nodiscard]] std::optional<answer::Outcome> most_frequent_wrong_decision() const;
    /// The first ray with this wrong decision; null if the form never makes it.
    [[nodiscard]] const WorstRay* first_of(answer::Outcome wrong) const;
    /// The first ray with the decision `most_frequent_wrong_decision()`; null if every decision is right.
    [[nodiscard]] const WorstRay* first_fault() const;
    /// The ray to examine first: `first_fault`, otherwise the one with the largest |ulp_error|; null if there is
    /// neither.
    [[nodiscard]] const WorstRay* worst_ray() const;
    /// Counts of the hits that errors are measured on.
    [[nodiscard]] metric::Agreement agreement() const { return {count(answer::Outcome::agree_hit), true_hit_count}; }
    /// Frees most of the memory of the distributions; see `metric::Distribution::seal`.
    void seal();
    /// Number of rays that truly miss, whatever the form answers.
    [[nodiscard]] std::uint64_t true_miss_count() const {
        return ray_count - true_hit_count - count(answer::Outcome::unresolved);
    }
};

/// Results of a tested form over some scanlines.
struct BandResult {
    int y0, scanlines, width;
    const truth::Band* band;
    const truth::FormatInputs* inputs;
    const answer::Answers* answers;
    intersect::Convention convention;
    std::vector<answer::Outcome> outcomes;
    /// One vector for each requested metric; NaN where the metric has no value.
    std::vector<std::vector<double>> metrics;

    /// Truth by the convention that the form is judged by.
    [[nodiscard]] truth::Truth truth(std::size_t i) const { return band->truth(i, convention); }
};

/// Receives a form's results (for files, plots, tests); may be empty. It is called for each band from top to bottom,
/// one band after another for one form. The results of different forms may be shown at the same time.
using Show = std::function<void(const BandResult&)>;
/// Receives the results of all tested forms, each with the index of its form.
using ShowForms = std::function<void(std::size_t form_index, const BandResult&)>;
/// Passes the bands of form i to the function `add_band` of readers[i]. The readers must outlive the result.
template <class Readers>
ShowForms show_to_each(Readers& readers) {
    return [&readers](std::size_t form_index, const BandResult& result) { readers.at(form_index).add_band(result); };
}

/// Metrics and receiver of one tested form.
struct FormRequest {
    const TestedForm& tested_form;
    const std::vector<const metric::Metric*>& metrics;
    Show show = {};
    int group = 0;           ///< index of the group in a sweep or case, for the rays that the summary names
    std::int64_t first = 0;  ///< index of the band's first ray if the rays are a list and not a picture
    /// Answers read from a file, which has no form to evaluate; null: the form is evaluated.
    const answer::Answers* answers = nullptr;
};

/// Evaluates a form on a band and adds the results to `summary`, which must be made for these metrics. `inputs` are the
/// band's inputs in the form's format.
void measure_form(const FormRequest& request, const truth::Band& band, const truth::FormatInputs& inputs,
                  FormSummary& summary);

/// Measures every tested form over all groups of rays; one summary for each, with sealed distributions.
std::vector<FormSummary> measure_groups(std::vector<scene::rays::RayGroup> groups,
                                        const std::vector<TestedForm>& tested_forms,
                                        const std::vector<const metric::Metric*>& metrics, truth::ProofLimit limit);

/// Inputs that must be computed for the metrics: their `Needs`, combined with or.
unsigned needs_of(const std::vector<const metric::Metric*>& metrics);
/// `Needs` that a form can provide. Answers from a file and external functions have no formula that could be recorded,
/// or evaluated without rounding.
unsigned needs_supported_by(const intersect::table::Intersector& form);

}  // namespace lostbits::measure::evaluate
