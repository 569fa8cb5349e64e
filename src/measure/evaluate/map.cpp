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
        group->rows.push_back(r);
    }
    return groups;
}

std::vector<study::RowsOfScene> MapStudy::scenes() const {
    std::vector<study::RowsOfScene> scenes_of_rows;
    for (FormsOfGenerator& group : group_by_generator(rows)) {
        auto row_scene = group.generator
                             ? std::make_shared<const scene::file::Scene>(with_ray_generator(*scene, *group.generator))
                             : study::non_owning_pointer(*scene);
        scenes_of_rows.push_back({std::move(row_scene), std::move(group.rows)});
    }
    return scenes_of_rows;
}

SharedBandTruth MapStudy::prepare(truth::Band& band, const std::vector<std::size_t>& row_indices) const {
    std::vector<TestedForm> band_rows;
    for (const std::size_t r : row_indices) band_rows.push_back(rows[r]);
    return {band, band_rows, metrics};
}

void MapStudy::measure(const SharedBandTruth& shared, std::size_t row_index, FormSummary& summary,
                       const Show& show) const {
    measure_row({rows[row_index], metrics, show}, shared.inputs_of(rows[row_index]), summary);
}

std::vector<FormSummary> run_map(const MapStudy& map, const ShowRows& show) { return study::run_share(map, show); }

}  // namespace lostbits::measure::evaluate
