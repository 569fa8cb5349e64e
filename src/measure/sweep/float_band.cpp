#include "measure/sweep/exhaustive.hpp"

#include <optional>

#include "measure/culling/culling.hpp"
#include "measure/evaluate/measure_row.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::TestedForm;

namespace {

const std::vector<const metric::Metric*>& measured() {
    static const std::vector<const metric::Metric*> metrics{metric::find_metric("ulp_error")};
    return metrics;
}

/// Floats on a ray, measured as one band.
class FloatBand {
public:
    explicit FloatBand(const FloatsOnRay& of)
        : rows_(of.request.rows),
          group_(of.request.sweep.group_over(of.ray, of.floats)),
          culler_(culler_of(group_)),
          band_(group_, of.request.limit, culler_ ? &*culler_ : nullptr),
          shared_(band_, rows_, measured()) {}

    void measure(std::size_t row, const evaluate::Show& show) const {
        evaluate::FormSummary summary(measured());
        evaluate::measure_row({rows_[row], measured(), show}, shared_.of(rows_[row]), summary);
    }
    [[nodiscard]] const truth::StageCounts& stages() const { return band_.stages(); }

private:
    static std::optional<culling::Culler> culler_of(const scene::rays::RayGroup& group) {
        if (!group.mesh) return std::nullopt;
        return culling::Culler(scene::rays::primitive_list_of(group), group.rays);
    }

    const std::vector<TestedForm>& rows_;
    scene::rays::RayGroup group_;
    std::optional<culling::Culler> culler_;
    truth::Band band_;
    evaluate::SharedBandTruth shared_;
};

}  // namespace

std::vector<FloatTally> try_floats_as_rays(const FloatsOnRay& of, truth::StageCounts& stages) {
    const FloatBand band(of);
    stages += band.stages();
    std::vector<FloatTally> tallies;
    for (std::size_t row = 0; row < of.request.rows.size(); ++row) {
        FloatTally& tally = tallies.emplace_back();
        band.measure(row, [&](const evaluate::BandResult& result) {
            for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
                const bool both_hit = result.outcomes[i] == Outcome::agree_hit;
                tally.add(of.floats.at(i), result.outcomes[i], both_hit ? result.metrics.front()[i] : truth::missing);
            }
        });
    }
    return tallies;
}

FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t row, std::uint32_t place) {
    FloatAnswer found;
    FloatBand({request, ray, {place, place}}).measure(row, [&](const evaluate::BandResult& result) {
        found.outcome = result.outcomes.front();
        if (result.answers->hit.front() != 0) found.t = result.answers->t.front();
        if (result.truth(0).is_hit())
            found.truth =
                result.band->rounded_truth(0, binary64, request.rows[row].form->info->direction, result.convention);
        if (found.outcome == Outcome::agree_hit) found.ulps = result.metrics.front().front();
    });
    return found;
}

}  // namespace lostbits::measure::sweep
