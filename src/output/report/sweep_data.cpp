#include "output/report/sweep_data.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "measure/evaluate/summary_columns.hpp"
#include "measure/truth/missing.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/report/text.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_plots.hpp"
#include "output/trade/trade_files.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::report {

using measure::metric::Metric;

namespace {

/// Numbers of a row at every step, cell or case:
/// `{"form":…,"format":…,"values":[statistic][cell],"outcomes":[cell][outcome],"true_hits":[cell]}`.
/// `summary_at(cell)` is the result of the row in that cell.
Json row_json(const measure::evaluate::TestedForm& tested_form, const std::vector<const Metric*>& metrics,
              std::size_t cell_count, const auto& summary_at) {
    const auto columns = measure::evaluate::make_summary_columns(metrics);
    Json values = Json::array(), outcomes = Json::array(), true_hits = Json::array();

    for (const std::string_view name : sweep_statistics) {
        const measure::evaluate::SummaryColumn* const column = measure::evaluate::find_column(columns, name);
        Json& column_values = values.emplace_back(Json::array());
        for (std::size_t c = 0; c < cell_count; ++c)
            column_values.push_back(number_json(column ? column->value(summary_at(c)) : measure::truth::missing));
    }

    for (std::size_t c = 0; c < cell_count; ++c) {
        outcomes.push_back(summary_at(c).outcomes);
        true_hits.push_back(summary_at(c).true_hit_count);
    }

    return {{"form", tested_form.form->info->name},
            {"format", tested_form.format.name},
            {"precision", tested_form.format.parameters.precision},
            {"from", attribution::plugin_options_for(tested_form.form->info->name)},
            {"values", std::move(values)},
            {"outcomes", std::move(outcomes)},
            {"true_hits", std::move(true_hits)}};
}

/// Adds the statistics and the rows of a sweep. `summary_at(r, cell)` is the result of row r in a cell.
/// `add_details(json, r)` adds the other members of row r.
Json with_rows(Json json, const auto& request, std::size_t cell_count, const auto& summary_at,
               const auto& add_details) {
    json["statistics"] = sweep_statistics;
    Json& rows = json["rows"] = Json::array();
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const auto row_summary_at = [&](std::size_t cell) -> const FormSummary& { return summary_at(r, cell); };
        add_details(rows.emplace_back(row_json(request.tested_forms[r], request.metrics, cell_count, row_summary_at)),
                    r);
    }
    return json;
}

Json axis_json(const scene::sweep::Axis& axis, const std::vector<double>& values) {
    return {{"name", axis.name}, {"label", axis.label}, {"values", json_array(values, number_json)}};
}

}  // namespace

Json sweep_json(const SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps,
                const std::vector<Onset>& onsets) {
    const scene::sweep::Axis& axis = request.sweep.axes.front();
    return with_rows(
        {{"id", request.sweep.id},
         {"kind", "line"},
         {"axis", axis.name},
         {"label", axis.label},
         {"steps", json_array(steps, [](const measure::sweep::SweepStep& s) { return number_json(s.values.front()); })},
         {"is_drawn", request.sweep.has_random_rays()}},
        request, steps.size(),
        [&](std::size_t r, std::size_t k) -> const FormSummary& { return steps[k].summaries[r]; },
        [&](Json& row, std::size_t r) {
            Json& row_onsets = row["onsets"] = Json::array();
            for (const Onset& onset : onsets) {
                if (onset.form_index != r || !onset.found) continue;
                const auto spread = onset.spread();
                row_onsets.push_back(
                    Json::array({onset.event, onset.statistic, number_json(onset.threshold),
                                 onset.happens_at_start ? Json() : number_json(onset.last_good),
                                 number_json(onset.first_bad), number_json(spread.low), number_json(spread.high)}));
            }
        });
}

Json plane_json(const SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps) {
    const sweep::SweepGrid plane(request, steps);
    const std::size_t columns = plane.x.size();
    const auto& axes = request.sweep.axes;
    return with_rows(
        {{"id", request.sweep.id},
         {"kind", "plane"},
         {"is_drawn", request.sweep.has_random_rays()},
         {"axes", Json::array({axis_json(axes[0], plane.x), axis_json(axes[1], plane.y)})}},
        request, columns * plane.y.size(),
        [&](std::size_t r, std::size_t cell) -> const FormSummary& {
            return plane.at(r, cell % columns, cell / columns);
        },
        [](Json&, std::size_t) {});
}

Json case_json(const measure::sweep::CaseRequest& request, const std::vector<std::vector<FormSummary>>& cases) {
    const scene::sweep::CaseFile& file = request.file;
    const std::size_t inherent_index = measure::metric::index_of(request.metrics, "inherent_bits");
    Json names = Json::array();
    for (std::size_t i = 0; i < file.size(); ++i) names.push_back(Json::array({file.name(i), file.case_note(i)}));

    // The file, its results, and for each row the verdicts and the bits that the inputs cost.
    return with_rows(
        {{"id", file.id},
         {"kind", "cases"},
         {"cases", names},
         {"within_means", sweep::within_meaning(file)},
         {"conventions", json_array(file.conventions, intersect::convention_name)}},
        request, cases.size(), [&](std::size_t r, std::size_t i) -> const FormSummary& { return cases[i][r]; },
        [&](Json& row, std::size_t r) {
            row["inherent"] = json_array(cases, [&](const std::vector<FormSummary>& case_summaries) {
                return number_json(inherent_index < request.metrics.size()
                                       ? case_summaries[r].metrics[inherent_index].quantile(1)
                                       : measure::truth::missing);
            });
            row["judged"] = intersect::convention_name(request.tested_forms[r].touching);
            row["verdicts"] = json_array(cases, [&](const std::vector<FormSummary>& case_summaries) {
                return measure::sweep::verdict_names[static_cast<std::size_t>(
                    measure::sweep::verdict_of(case_summaries[r], request.metrics, file.right_within_bits))];
            });
        });
}

namespace {

/// `427 (400 to 510)`: the onset in the file's own draw, and its range over all draws.
std::string onset_text(const Onset& onset) {
    const auto spread = onset.spread();
    return spread.low == spread.high ? number_html(onset.first_bad)
                                     : fmt::format("{} ({} to {})", number_html(onset.first_bad),
                                                   number_html(spread.low), number_html(spread.high));
}

/// Number of rays among which a first failure was found, and number of draws.
std::string draws_text(const std::vector<Onset>& onsets) {
    if (onsets.empty()) return "";
    const Onset& first_onset = onsets.front();
    return fmt::format(", among {}{}", text::count_with_noun(first_onset.ray_count, "ray"),
                       first_onset.further_first_bad.empty()
                           ? ""
                           : fmt::format(" ({} draws)", 1 + first_onset.further_first_bad.size()));
}

}  // namespace

namespace {

/// A column of the table of onsets.
struct EventColumn {
    /// Unit of the threshold. The threshold of a count is 1.
    enum class Threshold { bits, significands, count };
    const char *title, *event, *statistic;
    Threshold kind;
    double amount;

    [[nodiscard]] double threshold(const FloatFormat& format) const {
        return kind == Threshold::significands ? amount * format.precision : amount;
    }
};

/// Columns of the events. Most sweeps have one primitive, and most forms give no NaN, so columns of dashes are left
/// out.
std::vector<EventColumn> event_columns(const std::vector<Onset>& onsets) {
    using T = EventColumn::Threshold;
    std::vector<EventColumn> columns{{"p99 loses 4 bits", "lost_bits", "p99", T::bits, 4},
                                     {"p99 loses half", "lost_bits", "p99", T::significands, 0.5},
                                     {"p99 loses all", "lost_bits", "p99", T::significands, 1},
                                     {"first false hit", "false_hit", "count", T::count, 1},
                                     {"first false miss", "false_miss", "count", T::count, 1},
                                     {"first wrong primitive", "wrong_primitive", "count", T::count, 1},
                                     {"first NaN", "not_a_number", "count", T::count, 1}};
    std::erase_if(columns, [&onsets](const EventColumn& column) {
        return (std::string_view(column.event) == "wrong_primitive" ||
                std::string_view(column.event) == "not_a_number") &&
               std::ranges::none_of(
                   onsets, [&column](const Onset& onset) { return onset.found && onset.event == column.event; });
    });
    return columns;
}

/// Cell with the onset of an event for form `form_index`, or a dash.
std::string onset_cell(const std::vector<Onset>& onsets, std::size_t form_index, const EventColumn& column,
                       double threshold) {
    const auto onset = std::ranges::find_if(onsets, [&](const Onset& onset) {
        return onset.form_index == form_index && onset.event == column.event && onset.statistic == column.statistic &&
               onset.threshold == threshold;
    });
    const bool is_found = onset != onsets.end() && onset->found;
    return fmt::format("<td class=\"n\">{}{}</td>", is_found ? onset_text(*onset) : "&ndash;",
                       is_found && onset->happens_at_start ? " (from the start)" : "");
}

}  // namespace

std::string onset_table(const SweepRequest& request, const std::vector<Onset>& onsets) {
    const std::vector<EventColumn> columns = event_columns(onsets);
    std::vector<std::string> names{"form", "format"};
    for (const EventColumn& column : columns) names.emplace_back(column.title);
    std::string text = begin_table(names, "",
                                   fmt::format("First value of {} at which each event happens{}",
                                               html(request.sweep.axes.front().name), draws_text(onsets)));

    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const measure::evaluate::TestedForm& tested_form = request.tested_forms[r];
        text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td>", html(tested_form.form->info->name),
                            tested_form.format.name);
        for (const EventColumn& column : columns)
            text += onset_cell(onsets, r, column, column.threshold(tested_form.format.parameters));
        text += "</tr>\n";
    }
    return text + end_table;
}

Json trade_json(const measure::trade::TradeRequest& request, const measure::trade::TradeResult& result) {
    const auto sets = measure::trade::ray_sets(request.shape);
    Json parts = Json::array();
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto set_points = trade::pareto_points(request, result, s);
        Json points = Json::array();
        for (std::size_t k = 0; k < set_points.size(); ++k) {
            const measure::trade::TradeKernel& kernel = request.kernels[k];
            points.push_back({{"form", kernel.measured.form->info->name},
                              {"format", kernel.measured.format.name},
                              {"registers", trade::register_text(kernel)},
                              {"time_ns", number_json(set_points[k].time_ns)},
                              {"kept_bits", number_json(set_points[k].kept_bits)},
                              {"wrong_fraction", number_json(set_points[k].wrong_fraction)}});
        }
        parts.push_back({{"name", sets[s].name}, {"title", sets[s].title}, {"points", std::move(points)}});
    }
    return {{"shape", name_of(request.shape)}, {"sets", std::move(parts)}};
}

}  // namespace lostbits::output::report
