#include "output/map/sheet_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "output/blame/explain_command.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::map {

std::string input_note(const scene::file::Scene& scene, std::span<const measure::evaluate::TestedForm> rows) {
    if (scene.inputs == scene::file::Inputs::own)
        return "each format rounds the ideal scene itself: errors include what that costs (metric input_error)";
    std::vector<std::string> narrow;
    for (const measure::evaluate::TestedForm& row : rows) {
        if (!holds_shared_inputs(row.format.shape)) static_cast<void>(find_or_add(narrow, row.format.name));
    }
    if (narrow.empty()) return "";
    std::string names = narrow.front();
    for (std::size_t i = 1; i < narrow.size(); ++i) names += (i + 1 == narrow.size() ? " and " : ", ") + narrow[i];
    return fmt::format("in {} the inputs are rounded too: errors include what that costs (metric input_error)", names);
}

std::vector<std::string> sheet_subtitle(const scene::file::Scene& scene, const std::string& named,
                                        std::span<const measure::evaluate::TestedForm> rows, const MetricPaint& paint,
                                        bool several) {
    std::vector<std::string> lines{fmt::format("{}, {} x {} rays{}", scene.id, scene.width, scene.height,
                                               paint.metric().by_run ? "" : "; percentages are of all of them"),
                                   paint.note(several), paint.quantile_note(),
                                   rows.empty() ? "" : input_note(scene, rows)};
    if (!rows.empty())
        lines.push_back(fmt::format("forms: fewest wrong decisions in {} first, then the least p99 of lost bits there",
                                    rows.front().format.name));
    if (paint.names_worst())
        lines.push_back(fmt::format(
            "worst pixel X,Y: lostbits explain {} --pixel X,Y -i FORM -f FORMAT{} says how its answer came about",
            named, blame::where_forms_are_from()));
    std::erase(lines, "");
    return lines;
}

std::string cell_note(const MetricPaint& paint, const measure::evaluate::FormSummary& summary, std::size_t m) {
    const measure::evaluate::WorstRay* const worst = paint.names_worst() ? summary.worst_ray() : nullptr;
    return paint.glance(summary, m) + (worst ? fmt::format("\nworst pixel {},{}", worst->x, worst->y) : "");
}

std::vector<std::size_t> best_first(std::size_t forms, std::span<const SheetCell> cells, std::size_t lost) {
    constexpr double none = std::numeric_limits<double>::infinity();  // of too few hits: behind all others
    std::vector<std::optional<std::pair<std::uint64_t, double>>> worth(forms);
    for (const auto& [form, summary] : cells) {
        if (worth[form]) continue;
        const double p99 = lost < summary->metrics.size() && summary->agreement().is_enough()
                               ? summary->metrics[lost].quantile(0.99)
                               : none;
        worth[form].emplace(summary->wrong_count(), std::isnan(p99) ? none : p99);
    }
    std::vector<std::size_t> order(forms);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t form) {
        return worth[form].value_or(std::pair{std::numeric_limits<std::uint64_t>::max(), none});
    });
    return order;
}

}  // namespace lostbits::output::map
