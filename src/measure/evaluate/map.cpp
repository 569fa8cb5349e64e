#include "measure/evaluate/map.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::evaluate {

std::vector<FormsOfGenerator> group_by_generator(const std::vector<TestedForm>& tested_forms) {
    std::vector<FormsOfGenerator> groups;
    for (std::size_t r = 0; r < tested_forms.size(); ++r) {
        const auto* const generator = scene::rays::generator_of(*tested_forms[r].form);
        auto group = std::ranges::find(groups, generator, &FormsOfGenerator::generator);
        if (group == groups.end()) group = groups.insert(group, {generator, {}});
        group->form_indices.push_back(r);
    }
    return groups;
}

std::vector<study::FormsOfScene> MapStudy::scenes() const {
    std::vector<study::FormsOfScene> scenes_of_forms;
    for (FormsOfGenerator& group : group_by_generator(tested_forms)) {
        auto form_scene = group.generator
                              ? std::make_shared<const scene::file::Scene>(with_ray_generator(*scene, *group.generator))
                              : study::non_owning_pointer(*scene);
        scenes_of_forms.push_back({std::move(form_scene), std::move(group.form_indices)});
    }
    return scenes_of_forms;
}

SharedBandTruth MapStudy::prepare(truth::Band& band, const std::vector<std::size_t>& form_indices) const {
    std::vector<TestedForm> band_forms;
    for (const std::size_t r : form_indices) band_forms.push_back(tested_forms[r]);
    return {band, band_forms, metrics};
}

void MapStudy::measure(const SharedBandTruth& shared, std::size_t form_index, FormSummary& summary,
                       const Show& show) const {
    measure_form({tested_forms[form_index], metrics, show}, shared.inputs_of(tested_forms[form_index]), summary);
}

std::vector<FormSummary> run_map(const MapStudy& map, const ShowForms& show) { return study::run_share(map, show); }

}  // namespace lostbits::measure::evaluate
