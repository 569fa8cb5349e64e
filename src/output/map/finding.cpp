// Ranks the forms of a map, and writes a sentence about the best and the worst.
#include "output/map/finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"

namespace lostbits::output::map {

using measure::answer::Outcome;
namespace {

struct MeasuredForm {
    std::string name;
    const FormSummary* summary;
    double kept_bits;  ///< bits that 99 of 100 hits keep; -1 if too few hits agree
};

/// Kept bits to at most one decimal: `21.7`, `22`.
std::string bits_text(double kept_bits) {
    const std::string text = file::kept_bits_text(kept_bits);
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

/// Sort key of a form: better forms have smaller keys.
std::pair<std::uint64_t, double> sort_key(const MeasuredForm& form) {
    return {form.summary->wrong_count(), -form.kept_bits};
}

/// The forms that were measured in the format of the first tested form; empty if lost bits were not measured.
std::vector<MeasuredForm> measured_forms(const MapStudy& study, const std::vector<FormSummary>& summaries) {
    const std::size_t lost_bits_index = measure::metric::index_of(study.metrics, "lost_bits");
    std::vector<MeasuredForm> forms;
    for (std::size_t r = 0; r < summaries.size() && lost_bits_index < study.metrics.size(); ++r) {
        const auto& row = study.tested_forms[r];
        if (row.format != study.tested_forms.front().format) continue;

        const FormSummary& summary = summaries[r];
        const double kept_bits = row.format.parameters.precision - summary.metrics[lost_bits_index].quantile(0.99);
        forms.push_back({short_name(*row.form->info), &summary,
                         summary.agreement().is_enough() && !std::isnan(kept_bits) ? kept_bits : -1.0});
    }
    return forms;
}

/// A count and its fraction of a population of rays: `45 % of the empty rays`, `3 of the 4096 empty rays`. `all` only
/// if all of them are counted.
std::string count_and_fraction_text(std::uint64_t count, std::uint64_t population_size, const char* population) {
    const double percentage = 100 * static_cast<double>(count) / static_cast<double>(population_size);
    return count == population_size ? fmt::format("all {} {}", population_size, population)
           : percentage < 0.5       ? fmt::format("{} of the {} {}", count, population_size, population)
           : percentage > 99        ? fmt::format("{:.1f} % of the {}", std::min(percentage, 99.9), population)
                                    : fmt::format("{:.0f} % of the {}", percentage, population);
}

}  // namespace

std::string wrong_decision_text(const FormSummary& summary) {
    struct Fault {
        Outcome outcome;
        std::uint64_t population_size;  ///< number of rays that can have this outcome
        const char *verb, *population;
    };
    const std::uint64_t wrong = summary.wrong_count();
    if (wrong == 0) return "";

    // A kind that has more than half of the wrong decisions is named.
    for (const Fault& fault :
         {Fault{Outcome::false_hit, summary.true_miss_count(), "hits", "empty rays"},
          {Outcome::false_miss, summary.true_hit_count, "misses", "true hits"},
          {Outcome::not_a_number, summary.ray_count, "returns NaN for", "rays"},
          {Outcome::wrong_primitive, summary.true_hit_count, "hits the wrong primitive on", "true hits"}})
        if (2 * summary.count(fault.outcome) > wrong)
            return fmt::format(
                "{} {}", fault.verb,
                count_and_fraction_text(summary.count(fault.outcome), fault.population_size, fault.population));
    return fmt::format("decides {} wrongly", count_and_fraction_text(wrong, summary.ray_count, "rays"));
}

std::string finding_text(const MapStudy& study, const std::vector<FormSummary>& summaries) {
    const auto forms = measured_forms(study, summaries);
    if (forms.empty()) return "";

    // The sentence names the first of equally good forms. So does the sheet, where the others share its column.
    const MeasuredForm &best = *std::ranges::min_element(forms, {}, sort_key),
                       &worst = *std::ranges::max_element(forms, {}, sort_key);
    const auto& format = study.tested_forms.front().format;
    if (best.kept_bits < 0) return "";

    // Forms that all do equally well share a sentence.
    const std::string fault_text = wrong_decision_text(*worst.summary);
    if (forms.size() > 1 && fault_text.empty() && best.kept_bits - worst.kept_bits < 1)
        return fmt::format("{} keep {} of {} bits in {}",
                           forms.size() == 2 ? "Both forms" : fmt::format("All {} forms", forms.size()),
                           bits_text(worst.kept_bits), format.parameters.precision, format.name);

    // Otherwise: what the best form keeps, and what is wrong with the worst.
    const std::string text = fmt::format("{} keeps {} of {} bits in {}", best.name, bits_text(best.kept_bits),
                                         format.parameters.precision, format.name);
    if (fault_text.empty() && worst.kept_bits < 0) return text;
    if (forms.size() == 1) return fault_text.empty() ? text : fmt::format("{} and {}", text, fault_text);
    return fault_text.empty() ? fmt::format("{}; {} keeps {}", text, worst.name, bits_text(worst.kept_bits))
                              : fmt::format("{}; {} {}", text, worst.name, fault_text);
}

}  // namespace lostbits::output::map
