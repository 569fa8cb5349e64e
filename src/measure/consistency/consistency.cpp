#include "measure/consistency/consistency.hpp"

#include <algorithm>
#include <numeric>

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::consistency {

namespace {

void add_check(const PixelCheckResults& check_results, const ConsistencyBand& band, CheckSummary& summary) {
    for (const CheckResult result : check_results.results) ++summary.counts[static_cast<std::size_t>(result)];
    summary.apart.add(check_results.apart);
    summary.excess.add(check_results.excess);
    if (!check_results.first_disagreement || summary.first_disagreement) return;
    const auto pixel = static_cast<int>(check_results.first_disagreement->pixel);
    summary.first_disagreement =
        FirstDisagreement{pixel % band.width, band.y0 + pixel / band.width, *check_results.first_disagreement};
}

}  // namespace

std::uint64_t CheckSummary::question_count() const {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) - count_of(CheckResult::not_asked);
}

std::vector<const Check*> select_checks(const scene::file::Scene& scene,
                                        const std::vector<evaluate::TestedForm>& tested_forms,
                                        std::vector<const Check*> candidates) {
    std::erase_if(candidates, [&](const Check* check) {
        return std::ranges::none_of(tested_forms, [&](const evaluate::TestedForm& tested_form) {
            return check->applies(scene, *tested_form.form);
        });
    });
    return candidates;
}

bool can_be_compared(const intersect::table::Intersector& form) { return is_primitive(form.shape); }

void ConsistencyStudy::require() const { offset::require_few_primitives(scene); }

ConsistencyBand ConsistencyStudy::measure(const truth::Band& band, std::size_t form_index, FormChecks& summary) const {
    const FormOnBand band_form(scene, tested_forms[form_index], band);
    ConsistencyBand result_band{.y0 = band.y0(), .scanlines = band.scanlines(), .width = scene.width, .checks = {}};
    for (std::size_t c = 0; c < checks.size(); ++c) {
        PixelCheckResults& pixel_results = result_band.checks.emplace_back(band_form.pixel_count());
        if (checks[c]->applies(scene, *tested_forms[form_index].form)) checks[c]->measure(band_form, pixel_results);
        add_check(pixel_results, result_band, summary[c]);
    }
    return result_band;
}

}  // namespace lostbits::measure::consistency
