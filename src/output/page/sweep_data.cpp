#include "output/page/sweep_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "measure/map/summary_columns.hpp"
#include "measure/truth/missing.hpp"
#include "output/page/text.hpp"
#include "output/speed/trade_files.hpp"

namespace lostbits::output::page {

using measure::map::MapSummary;
using measure::metric::Metric;
using measure::sweep::Onset;

namespace {

template <class Items, class Text>
std::string list(const Items& items, const Text& text) {
    std::vector<std::string> all;
    for (const auto& item : items) all.push_back(text(item));
    return fmt::format("[{}]", fmt::join(all, ","));
}

const char* spacing_name(scene::sweep::Axis::Spacing s) {
    using S = scene::sweep::Axis::Spacing;
    return s == S::log2 ? "log2" : s == S::linear ? "linear" : s == S::whole ? "whole" : "every_float";
}

}  // namespace

std::string row_fields(const measure::map::MapRow& row, const std::vector<const Metric*>& metrics, std::size_t cells,
                       const std::function<const MapSummary&(std::size_t)>& at) {
    const auto columns = measure::map::summary_columns(metrics);
    std::vector<std::string> values, outcomes;
    for (const std::string_view name : sweep_statistics) {
        const measure::map::SummaryColumn* const column = measure::map::find_column(columns, name);
        std::vector<std::string> all;
        for (std::size_t c = 0; c < cells; ++c)
            all.push_back(number(column ? column->value(at(c)) : measure::truth::missing));
        values.push_back(fmt::format("[{}]", fmt::join(all, ",")));
    }
    for (std::size_t c = 0; c < cells; ++c) outcomes.push_back(fmt::format("[{}]", fmt::join(at(c).outcomes, ",")));
    return fmt::format(R"("form":{},"format":{},"values":[{}],"outcomes":[{}])", json_text(row.form->info->name),
                       json_text(row.format.name), fmt::join(values, ","), fmt::join(outcomes, ","));
}

std::string sweep_json(const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps,
                       const std::vector<Onset>& onsets) {
    const scene::sweep::Axis& axis = request.sweep->axes.front();
    std::vector<std::string> rows;
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        std::vector<std::string> found;
        for (const Onset& o : onsets) {
            if (o.row != r || !o.found) continue;
            found.push_back(fmt::format("[{},{},{},{},{}]", json_text(o.event), json_text(o.statistic),
                                        number(o.threshold), o.from_start ? "null" : number(o.last_good),
                                        number(o.first_bad)));
        }
        const auto numbers = row_fields(request.rows[r], request.metrics, steps.size(),
                                        [&](std::size_t k) -> const MapSummary& { return steps[k].rows[r]; });
        rows.push_back(fmt::format(R"({{{},"onsets":[{}]}})", numbers, fmt::join(found, ",")));
    }
    return fmt::format(
        R"({{"id":{},"title":{},"kind":"line","axis":{},"unit":{},"spacing":"{}","steps":{},"statistics":{},"rows":[{}]}})",
        json_text(request.sweep->id), json_text(request.sweep->title), json_text(axis.name), json_text(axis.unit),
        spacing_name(axis.spacing),
        list(steps, [](const measure::sweep::SweepStep& s) { return number(s.values.front()); }),
        list(sweep_statistics, json_text), fmt::join(rows, ","));
}

std::string onset_table(const measure::sweep::SweepRequest& request, const std::vector<Onset>& onsets) {
    struct Wanted {
        const char *title, *event, *statistic;
        double share;  ///< of the significand; 0: the threshold is one
    };
    static constexpr Wanted wanted[] = {{"p99 loses 4 bits", "lost_bits", "p99", 4},
                                        {"p99 loses half", "lost_bits", "p99", 0.5},
                                        {"p99 loses all", "lost_bits", "p99", 1},
                                        {"first false hit", "false_hit", "count", 0},
                                        {"first false miss", "false_miss", "count", 0}};
    const std::string axis = html(request.sweep->axes.front().name);
    std::string text = fmt::format(
        "<table><caption>First value of {} at which it happens</caption><thead><tr><th scope=\"col\">form</th><th "
        "scope=\"col\">format</th>",
        axis);
    for (const Wanted& w : wanted) text += fmt::format("<th scope=\"col\">{}</th>", w.title);
    text += "</tr></thead><tbody>\n";
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const measure::map::MapRow& row = request.rows[r];
        text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td>", html(row.form->info->name), row.format.name);
        for (const Wanted& w : wanted) {
            const double threshold = w.share == 0 ? 1 : w.share == 4 ? 4 : w.share * row.format.shape.precision;
            const auto found = std::ranges::find_if(onsets, [&](const Onset& o) {
                return o.row == r && o.event == w.event && o.statistic == w.statistic && o.threshold == threshold;
            });
            const bool is = found != onsets.end() && found->found;
            text += fmt::format("<td class=\"n\">{}{}</td>", is ? shown(found->first_bad) : "&ndash;",
                                is && found->from_start ? " (from the start)" : "");
        }
        text += "</tr>\n";
    }
    return text + "</tbody></table>\n";
}

std::string trade_json(const measure::speed::TradeRequest& request, const measure::speed::TradeResult& result) {
    const auto sets = measure::speed::ray_sets(request.shape);
    std::vector<std::string> parts;
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto all = speed::pareto_points_of(request, result, s);
        const auto beaten = measure::speed::dominated(all);
        std::vector<std::string> points;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const measure::speed::TradeKernel& kernel = request.kernels[k];
            points.push_back(fmt::format(
                R"({{"form":{},"name":{},"format":{},"isa":{},"time_ns":{},"kept_bits":{},"wrong_fraction":{},"dominated":{}}})",
                json_text(kernel.form->name), json_text(kernel.measured.form->info->name),
                json_text(kernel.measured.format.name), json_text(kernel.isa), number(all[k].time_ns),
                number(all[k].kept_bits), number(all[k].wrong_fraction), beaten[k] ? "true" : "false"));
        }
        parts.push_back(fmt::format(R"({{"name":{},"title":{},"points":[{}]}})", json_text(sets[s].name),
                                    json_text(sets[s].title), fmt::join(points, ",")));
    }
    return fmt::format(R"({{"shape":{},"sets":[{}]}})", json_text(shape_names[static_cast<std::size_t>(request.shape)]),
                       fmt::join(parts, ","));
}

}  // namespace lostbits::output::page
