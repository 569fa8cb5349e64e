#include "measure/sweep/exhaustive.hpp"

#include <optional>

#include "measure/culling/culling.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::TestedForm;

namespace {

const std::vector<const metric::Metric*>& measured_metrics() {
    static const std::vector<const metric::Metric*> metrics{metric::find_metric("ulp_error")};
    return metrics;
}

/// Floats on a ray, measured as one band.
class FloatBand {
public:
    explicit FloatBand(const FloatsOnRay& floats_on_ray)
        : tested_forms_(floats_on_ray.request.tested_forms),
          group_(floats_on_ray.request.sweep.group_of_floats(floats_on_ray.ray, floats_on_ray.floats)),
          culler_(make_culler(group_)),
          band_(group_, floats_on_ray.request.limit, culler_ ? &*culler_ : nullptr),
          shared_truth_(band_, tested_forms_, measured_metrics()) {}

    void measure(std::size_t form_index, const evaluate::Show& show) const {
        evaluate::FormSummary summary(measured_metrics());
        evaluate::measure_form({tested_forms_[form_index], measured_metrics(), show},
                               shared_truth_.inputs_of(tested_forms_[form_index]), summary);
    }
    [[nodiscard]] const truth::StageCounts& stages() const { return band_.stages(); }

private:
    static std::optional<culling::Culler> make_culler(const scene::rays::RayGroup& group) {
        if (!group.mesh) return std::nullopt;
        return culling::Culler(scene::rays::primitive_list_of(group), group.rays);
    }

    const std::vector<TestedForm>& tested_forms_;
    scene::rays::RayGroup group_;
    std::optional<culling::Culler> culler_;
    truth::Band band_;
    evaluate::SharedBandTruth shared_truth_;
};

}  // namespace

std::vector<FloatTally> try_floats_as_rays(const FloatsOnRay& floats_on_ray, truth::StageCounts& stages) {
    const FloatBand band(floats_on_ray);
    stages += band.stages();
    std::vector<FloatTally> tallies;
    for (std::size_t form_index = 0; form_index < floats_on_ray.request.tested_forms.size(); ++form_index) {
        FloatTally& tally = tallies.emplace_back();
        band.measure(form_index, [&](const evaluate::BandResult& result) {
            for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
                const bool both_hit = result.outcomes[i] == Outcome::agree_hit;
                tally.add(floats_on_ray.floats.at(i), result.outcomes[i],
                          both_hit ? result.metrics.front()[i] : truth::missing);
            }
        });
    }
    return tallies;
}

FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t form_index,
                      std::uint32_t float_index) {
    FloatAnswer float_answer;
    FloatBand({request, ray, {float_index, float_index}}).measure(form_index, [&](const evaluate::BandResult& result) {
        float_answer.outcome = result.outcomes.front();
        if (result.answers->hit.front() != 0) float_answer.t = result.answers->t.front();
        if (result.truth(0).is_hit())
            float_answer.truth = result.band->rounded_truth(
                0, binary64, request.tested_forms[form_index].form->info->direction, result.convention);
        if (float_answer.outcome == Outcome::agree_hit) float_answer.ulps = result.metrics.front().front();
    });
    return float_answer;
}

}  // namespace lostbits::measure::sweep
