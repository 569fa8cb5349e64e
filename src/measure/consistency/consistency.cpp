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

using C = CheckSummary;

double as_number(std::uint64_t n) { return static_cast<double>(n); }
template <CheckResult a>
double pixel_count(const C& s) {
    return as_number(s.count_of(a));
}
template <CheckResult a>
double result_fraction(const C& s) {
    return truth::fraction(s.count_of(a), s.question_count());
}
template <metric::Distribution C::*numbers, int percent>
double quantile_of(const C& s) {
    return (s.*numbers).quantile(percent / 100.0);
}

constexpr ConsistencyColumn column_rows[] = {
    {"rays", "", "pixels at which both questions are asked", true,
     [](const C& s) { return as_number(s.question_count()); }},
    {"agree", "", "of these, pixels with the same answer to both questions", true, pixel_count<CheckResult::agree>},
    {"first_alone", "", "the answer is yes only to the first question, and one of the answers is wrong", true,
     pixel_count<CheckResult::first_alone>},
    {"second_alone", "", "the answer is yes only to the second, and one of the answers is wrong", true,
     pixel_count<CheckResult::second_alone>},
    {"other_number", "",
     "the decisions are the same, the numbers are not: they differ in any bit (packs), or by an ulp more than the "
     "exact ones (reverse, placed)",
     true, pixel_count<CheckResult::other_number>},
    {"by_inputs", "", "the answers differ as the exact ones do: the stored numbers of the questions differ", true,
     pixel_count<CheckResult::by_inputs>},
    {"unresolved", "", "the answers differ, and the exact ones are not proved", true,
     pixel_count<CheckResult::unresolved>},
    {"disagree_fraction", "", "share of first_alone, second_alone and other_number", false,
     [](const C& s) { return truth::fraction(s.disagreements(), s.question_count()); }},
    {"decision_fraction", "", "share of first_alone and second_alone", false,
     [](const C& s) { return truth::fraction(s.decisions(), s.question_count()); }},
    {"by_inputs_fraction", "", "share of by_inputs", false, result_fraction<CheckResult::by_inputs>},
    {"apart_p50", "ulp",
     "|near + far from the other end - length| in ulps of the length; for placed |t - the other t| in ulps of t, as "
     "computed: "
     "median",
     false, quantile_of<&C::apart, 50>},
    {"apart_p99", "ulp", "the same: 99th percentile", false, quantile_of<&C::apart, 99>},
    {"apart_max", "ulp", "the same: largest", false, quantile_of<&C::apart, 100>},
    {"excess_p50", "ulp", "the same minus its value for the exact answers: median", false, quantile_of<&C::excess, 50>},
    {"excess_p99", "ulp", "the same: 99th percentile", false, quantile_of<&C::excess, 99>},
    {"excess_max", "ulp", "the same: largest", false, quantile_of<&C::excess, 100>},
};

}  // namespace

std::uint64_t CheckSummary::question_count() const {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) - count_of(CheckResult::not_asked);
}

std::vector<const Check*> checks_for(const scene::file::Scene& scene,
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
        PixelCheckResults& pixel_results = result_band.checks.emplace_back(band_form.pixels());
        if (checks[c]->applies(scene, *tested_forms[form_index].form)) checks[c]->measure(band_form, pixel_results);
        add_check(pixel_results, result_band, summary[c]);
    }
    return result_band;
}

std::span<const ConsistencyColumn> consistency_columns() { return column_rows; }

}  // namespace lostbits::measure::consistency
