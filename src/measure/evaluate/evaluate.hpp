// The engine: every selected form in every selected format over every ray of a scene, against one truth.
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
#include "measure/shard/share.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::evaluate {

/// One row of the work: a form in a format.
struct TestedForm {
    const intersect::table::Intersector* form;
    Format format;
    /// By whose convention on touching it is judged; its own where absent.
    std::optional<intersect::Touching> judged = {};

    /// The form that it is held against, which exists in the format; none where null.
    const intersect::table::Intersector* against = nullptr;

    [[nodiscard]] intersect::Convention convention() const { return form->info->convention(judged); }
    friend bool operator==(const TestedForm&, const TestedForm&) = default;
};

/// The forms of the rows, each once, in their order.
std::vector<const intersect::table::Intersector*> forms_of(const std::vector<TestedForm>& rows);

/// A ray that a summary names, with everything it takes to ask the form again.
struct WorstRay {
    std::int64_t x = -1;  ///< of a ray of a list its place: a file may have more than 2^31
    int y = -1;
    int group = 0;             ///< which set of rays of a sweep or of a case it is in, from 0
    std::int64_t object = -1;  ///< the solid that the form hit; of rays with a solid each the ray's place
    double size = -1;          ///< |ulp_error|; of a wrong decision 0
    Ray<double> ray{};  ///< in the format; a unit-direction form gets the direction normalised, so its t is a distance
    Solid<double> solid{};
    double t = 0;
    answer::Outcome outcome = answer::Outcome::agree_hit;
    double ulps = truth::missing;   ///< (t − t*)/ulp(t*), signed; NaN unless both hit
    double truth = truth::missing;  ///< t*, correctly rounded to binary64; NaN where the ray truly misses
    std::optional<intersect::Touching> judged = {};
    /// The ray before the format rounded it, with the solids that decide; null for a pixel of a scene, and where there
    /// are too many solids.
    std::shared_ptr<const scene::rays::RayGroup> given = {};
};

using answer::is_wrong, answer::wrong_decisions;

/// What is known of a row when the whole picture has been seen.
struct FormSummary {
    std::uint64_t rays = 0;
    std::uint64_t views =
        1;  ///< sets of rays with solids of their own: the independent samples of what rays of one set share
    std::array<std::uint64_t, answer::outcome_names.size()> outcomes{};
    std::uint64_t true_hits = 0;                ///< rays that truly hit, whatever the form says
    std::vector<metric::Distribution> metrics;  ///< in the order of the request's metrics
    /// For each metric that names a category, how many rays are of each; empty for the others.
    std::vector<std::vector<std::uint64_t>> categories;
    WorstRay worst;
    /// The first ray of each of the `wrong_decisions`; null where there is none.
    std::array<std::unique_ptr<WorstRay>, wrong_decisions.size()> faults;

    FormSummary() = default;
    explicit FormSummary(const std::vector<const metric::Metric*>& measured);
    /// To the distribution of metric m, or to the counts of its categories; NaN is no value.
    void add(std::size_t m, const metric::Metric& metric, std::span<const double> values);
    /// What is known of further rays, all of which come after those that are known here.
    void append(FormSummary&& after);
    [[nodiscard]] std::uint64_t count(answer::Outcome o) const { return outcomes[static_cast<std::size_t>(o)]; }
    /// Of all the `wrong_decisions`.
    [[nodiscard]] std::uint64_t wrong_count() const;
    /// The most frequent of the `wrong_decisions`; nothing where every decision is right.
    [[nodiscard]] std::optional<answer::Outcome> wrong() const;
    /// The first ray that is decided so wrongly; null where there is none.
    [[nodiscard]] const WorstRay* first_of(answer::Outcome wrong) const;
    /// That of `wrong`; null where every decision is right.
    [[nodiscard]] const WorstRay* fault() const;
    /// The ray to look at first: `fault`, else the one with the largest |ulp_error|; null where there is neither.
    [[nodiscard]] const WorstRay* worst_ray() const;
    /// The hits that errors are measured on.
    [[nodiscard]] metric::Agreement agreement() const { return {count(answer::Outcome::agree_hit), true_hits}; }
    /// Rays that truly miss, whatever the form says.
    [[nodiscard]] std::uint64_t true_misses() const { return rays - true_hits - count(answer::Outcome::unresolved); }
};

/// A row's results over some scanlines.
struct BandResult {
    int y0, rows, width;
    const truth::Band* band;
    const truth::FormatInputs* inputs;
    const answer::Answers* answers;
    intersect::Convention convention;
    std::vector<answer::Outcome> outcomes;
    /// One vector per requested metric; NaN where the metric does not exist.
    std::vector<std::vector<double>> metrics;

    /// By the convention that the row is judged by.
    [[nodiscard]] truth::Truth truth(std::size_t i) const { return band->truth(i, convention); }
};

/// Where a row's results go (files, plots, tests), or nothing. Called band by band from top to bottom, never
/// concurrently for one row; different rows are shown at the same time.
using Show = std::function<void(const BandResult&)>;
/// To the `band` of each of the readers, which outlive it: the rows in their order.
template <class Readers>
std::vector<Show> shown_to_each(Readers& readers) {
    std::vector<Show> shows;
    for (auto& reader : readers) shows.push_back([&reader](const BandResult& result) { reader.band(result); });
    return shows;
}

/// What one row is to be measured by, and who is shown it.
struct RowRequest {
    const TestedForm& row;
    const std::vector<const metric::Metric*>& metrics;
    Show show = {};
    int group = 0;           ///< of a sweep or case, for the rays that the summary names
    std::int64_t first = 0;  ///< the place of the band's first ray, where rays are a list and no picture
    /// What was answered, where a file has it and no form can be asked; null: the form is asked.
    const answer::Answers* answers = nullptr;
};

/// Evaluates a row on a band, of which `inputs` are those of its format, and adds what it finds to `summary`, which is
/// made for these metrics.
void measure_row(const RowRequest& request, const truth::Band& band, const truth::FormatInputs& inputs,
                 FormSummary& summary);

/// Every row over all groups of rays, one summary per row, their distributions sealed.
std::vector<FormSummary> measure_groups(std::vector<scene::rays::RayGroup> groups, const std::vector<TestedForm>& rows,
                                        const std::vector<const metric::Metric*>& metrics, truth::TruthLimit limit);

/// What the metrics need computed first: `Needs`, or-ed.
unsigned needs_of(const std::vector<const metric::Metric*>& metrics);
/// Those that a row can meet: a file's, or someone else's function, has no formula to evaluate without rounding or to
/// record.
unsigned needs_met_by(const intersect::table::Intersector& form);

struct EvaluationRequest {
    const scene::file::Scene* scene = nullptr;
    std::vector<TestedForm> rows;
    std::vector<const metric::Metric*> metrics;
    truth::TruthLimit limit{};
    /// Where which stages settled the truths of the rays is added up; null: nowhere.
    truth::StageCounts* stages = nullptr;
    shard::Share share = {};  ///< of the bands
    /// Called after each band with the number of (pixel, row) pairs done; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Runs the map; shows[i] is shown rows[i]. Memory does not grow with the height of the picture, and the
/// results do not depend on the number of threads: bands are cut by the picture alone and each row is summed in order.
std::vector<FormSummary> evaluate_rows(const EvaluationRequest& request, const std::vector<Show>& shows);

/// Scanlines per band: about 32768 pixels, in multiples of EXR's 16-line blocks.
int band_rows(int width);

/// The first line of each band of a picture that a share has.
std::vector<int> bands_of(int width, int height, shard::Share share);

}  // namespace lostbits::measure::evaluate
