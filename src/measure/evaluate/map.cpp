#include "measure/evaluate/map.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::evaluate {

std::vector<FormsOfGenerator> by_generator(const std::vector<TestedForm>& rows) {
    std::vector<FormsOfGenerator> all;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto* const generator = scene::rays::generator_of(*rows[r].form);
        auto found = std::ranges::find(all, generator, &FormsOfGenerator::generator);
        if (found == all.end()) found = all.insert(found, {generator, {}});
        found->rows.push_back(r);
    }
    return all;
}

std::vector<study::RowsOfScene> MapStudy::scenes() const {
    std::vector<study::RowsOfScene> all;
    for (FormsOfGenerator& some : by_generator(rows)) {
        auto made = some.generator ? std::make_shared<const scene::file::Scene>(with_rays(*scene, *some.generator))
                                   : study::not_owned(*scene);
        all.push_back({std::move(made), std::move(some.rows)});
    }
    return all;
}

SharedBandTruth MapStudy::prepare(truth::Band& band, const std::vector<std::size_t>& row_indices) const {
    std::vector<TestedForm> its_rows;
    for (const std::size_t r : row_indices) its_rows.push_back(rows[r]);
    return {band, its_rows, metrics};
}

void MapStudy::measure(const SharedBandTruth& shared, std::size_t row, FormSummary& summary, const Show& show) const {
    measure_row({rows[row], metrics, show}, shared.of(rows[row]), summary);
}

std::vector<FormSummary> run_map(const MapStudy& map, const ShowRows& show) { return study::run_share(map, show); }

}  // namespace lostbits::measure::evaluate
