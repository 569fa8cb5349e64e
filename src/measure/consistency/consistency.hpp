// Compares the answers of a form to the same question asked in two ways, for every pixel of a scene.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "measure/consistency/check.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/shard/share.hpp"
#include "measure/study/sums.hpp"

namespace lostbits::measure::consistency {

/// First disagreement of a check: the pixel of the picture and the rays of both questions.
struct FirstDisagreement {
    int x = 0, y = 0;
    RayPair rays;
};

/// Results of one check over all pixels of a row.
struct CheckSummary {
    std::array<std::uint64_t, check_result_names.size()> counts{};
    metric::Distribution apart, excess;  ///< for checks that compare numbers, in ulps
    std::optional<FirstDisagreement> first_disagreement;

    [[nodiscard]] std::uint64_t count_of(CheckResult a) const { return counts[static_cast<std::size_t>(a)]; }
    /// Number of pixels at which both questions are asked.
    [[nodiscard]] std::uint64_t question_count() const;
    /// Number of differences that the form causes. `decisions` counts those in which the decisions differ.
    [[nodiscard]] std::uint64_t disagreements() const { return decisions() + count_of(CheckResult::other_number); }
    [[nodiscard]] std::uint64_t decisions() const {
        return count_of(CheckResult::first_alone) + count_of(CheckResult::second_alone);
    }
};

LOSTBITS_FIELDS(RayPair, pixel, first, second)
LOSTBITS_FIELDS(FirstDisagreement, x, y, rays)
LOSTBITS_FIELDS(CheckSummary, counts, apart, excess, first_disagreement)

/// One summary for each check of the request. A check that does not apply has only `not_asked` pixels.
using FormChecks = std::vector<CheckSummary>;

/// Results of a row on some scanlines, one element for each check of the request.
struct ConsistencyBand {
    int y0 = 0, scanlines = 0, width = 0;
    std::vector<PixelCheckResults> checks;
};

/// A study, see measure/study/study.hpp.
struct ConsistencyStudy {
    using Band = ConsistencyBand;
    using Summary = FormChecks;
    static constexpr int pixels_per_band = 1;  ///< few, so that the rays of a band stay in the cache

    const scene::file::Scene& scene;
    std::vector<evaluate::TestedForm> tested_forms;  ///< with forms of primitives
    std::vector<const Check*> checks;
    truth::ProofLimit limit{};
    shard::Share share = {};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Throws InputError for a scene with too many primitives.
    void require() const;
    [[nodiscard]] FormChecks begin(std::size_t) const { return FormChecks(checks.size()); }
    [[nodiscard]] static const truth::Band& prepare(const truth::Band& band) { return band; }
    ConsistencyBand measure(const truth::Band& band, std::size_t form_index, FormChecks& summary) const;
};

/// Returns those of the candidates that apply to at least one of the forms on a scene.
std::vector<const Check*> select_checks(const scene::file::Scene& scene,
                                        const std::vector<evaluate::TestedForm>& tested_forms,
                                        std::vector<const Check*> candidates = all_checks());

/// True if the form intersects a primitive. Forms that march a distance field are not compared.
bool can_be_compared(const intersect::table::Intersector& form);

}  // namespace lostbits::measure::consistency
