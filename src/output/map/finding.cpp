#include "output/map/finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "output/file/number_text.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::map {

using measure::answer::Outcome;
namespace {

struct FoundForm {
    std::string name;
    const FormSummary* summary;
    double kept;  ///< bits that 99 of 100 hits keep; -1 if too few hits agree
};

/// `21.7`, `22`
std::string bits_text(double kept) {
    const std::string text = file::kept_text(kept);
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

/// The better form comes first.
std::pair<std::uint64_t, double> rank_of(const FoundForm& form) { return {form.summary->wrong_count(), -form.kept}; }

std::vector<FoundForm> forms_of(const MapStudy& request, const std::vector<FormSummary>& summaries) {
    const std::size_t lost = measure::metric::index_of(request.metrics, "lost_bits");
    std::vector<FoundForm> forms;
    for (std::size_t r = 0; r < summaries.size() && lost < request.metrics.size(); ++r) {
        const auto& row = request.rows[r];
        if (row.format != request.rows.front().format) continue;
        const FormSummary& s = summaries[r];
        const double kept = row.format.parameters.precision - s.metrics[lost].quantile(0.99);
        forms.push_back(
            {short_name(*row.form->info), &s, s.agreement().is_enough() && !std::isnan(kept) ? kept : -1.0});
    }
    return forms;
}

/// `45 % of the empty rays`, `3 of the 4096 empty rays`; 100 % only if it is all of them
std::string count_and_share_text(std::uint64_t n, std::uint64_t of, const char* rays) {
    const double share = 100 * static_cast<double>(n) / static_cast<double>(of);
    return n == of       ? fmt::format("all {} {}", of, rays)
           : share < 0.5 ? fmt::format("{} of the {} {}", n, of, rays)
           : share > 99  ? fmt::format("{:.1f} % of the {}", std::min(share, 99.9), rays)
                         : fmt::format("{:.0f} % of the {}", share, rays);
}

}  // namespace

std::string wrong_decision_text(const FormSummary& s) {
    struct Fault {
        Outcome outcome;
        std::uint64_t of;
        const char *does, *rays;
    };
    const std::uint64_t wrong = s.wrong_count();
    if (wrong == 0) return "";
    for (const Fault& fault : {Fault{Outcome::false_hit, s.true_misses(), "hits", "empty rays"},
                               {Outcome::false_miss, s.true_hits, "misses", "true hits"},
                               {Outcome::not_a_number, s.rays, "returns NaN for", "rays"},
                               {Outcome::wrong_primitive, s.true_hits, "hits the wrong primitive on", "true hits"}})
        if (2 * s.count(fault.outcome) > wrong)
            return fmt::format("{} {}", fault.does, count_and_share_text(s.count(fault.outcome), fault.of, fault.rays));
    return fmt::format("decides {} wrongly", count_and_share_text(wrong, s.rays, "rays"));
}

std::string finding_text(const MapStudy& request, const std::vector<FormSummary>& summaries) {
    const auto forms = forms_of(request, summaries);
    if (forms.empty()) return "";
    // Names the first of forms that are equally good, as on the sheet, where the others share its column.
    const FoundForm &best = *std::ranges::min_element(forms, {}, rank_of),
                    &worst = *std::ranges::max_element(forms, {}, rank_of);
    const auto& format = request.rows.front().format;
    if (best.kept < 0) return "";
    const std::string kept = fmt::format("{} of {} bits in {}", bits_text(best.kept), format.parameters.precision,
                                         format.name),
                      fault = wrong_decision_text(*worst.summary);
    if (forms.size() > 1 && fault.empty() && best.kept - worst.kept < 1)
        return fmt::format("{} keep {} of {} bits in {}",
                           forms.size() == 2 ? "Both forms" : fmt::format("All {} forms", forms.size()),
                           bits_text(worst.kept), format.parameters.precision, format.name);
    std::string text = fmt::format("{} keeps {}", best.name, kept);
    if (fault.empty() && worst.kept < 0) return text;
    if (forms.size() == 1) return fault.empty() ? text : fmt::format("{} and {}", text, fault);
    return fault.empty() ? fmt::format("{}; {} keeps {}", text, worst.name, bits_text(worst.kept))
                         : fmt::format("{}; {} {}", text, worst.name, fault);
}

}  // namespace lostbits::output::map
