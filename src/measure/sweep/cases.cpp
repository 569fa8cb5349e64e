#include "measure/sweep/cases.hpp"

#include <map>

#include "intersect/process/parallel.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::FormSummary;

FormSummary run_cases_together(const CaseRequest& request, std::size_t row, const std::vector<std::size_t>& numbers) {
    const evaluate::TestedForm& what = request.rows[row];
    std::vector<scene::rays::RayGroup> groups;
    for (const std::size_t number : numbers) {
        for (scene::rays::RayGroup& group : request.file->rays(number, what.format.shape))
            groups.push_back(std::move(group));
    }
    return std::move(evaluate::measure_groups(std::move(groups), {what}, request.metrics, request.limit).front());
}

std::vector<std::vector<FormSummary>> run_cases(const CaseRequest& request) {
    std::map<std::string, std::vector<std::size_t>> by_format;
    for (std::size_t row = 0; row < request.rows.size(); ++row) by_format[request.rows[row].format.name].push_back(row);
    const auto units = request.share.of_units(request.file->size());
    std::vector<std::vector<FormSummary>> cases(units.size());
    intersect::process::in_parallel(std::size_t{0}, cases.size(), [&](std::size_t i) {
        cases[i].resize(request.rows.size());
        for (const auto& [name, places] : by_format) {
            std::vector<evaluate::TestedForm> rows;
            for (const std::size_t row : places) rows.push_back(request.rows[row]);
            auto summaries = evaluate::measure_groups(request.file->rays(units.first + i, rows.front().format.shape),
                                                      rows, request.metrics, request.limit);
            for (std::size_t k = 0; k < places.size(); ++k) cases[i][places[k]] = std::move(summaries[k]);
        }
        request.progress(request.rows.size());
    });
    return cases;
}

Verdict verdict_of(const FormSummary& s, const std::vector<const metric::Metric*>& metrics, double within) {
    if (s.count(Outcome::unresolved) > 0) return Verdict::unresolved;
    if (const auto wrong = s.wrong()) {
        return *wrong == Outcome::not_a_number ? Verdict::not_a_number
               : *wrong == Outcome::false_miss ? Verdict::false_miss
               : *wrong == Outcome::false_hit  ? Verdict::false_hit
                                               : Verdict::wrong_object;
    }
    // NaN where no hit is agreed on: nothing is lost then.
    const auto most = [&](const char* name) { return s.metrics[metric::place_of(metrics, name)].quantile(1); };
    if (most("excess_bits") > within) return Verdict::wrong_value;
    return most("lost_bits") > within ? Verdict::within_inputs : Verdict::right;
}

}  // namespace lostbits::measure::sweep
