#include "output/map/sheet_words.hpp"

#include <fmt/format.h>

#include "output/map/row_names.hpp"

namespace lostbits::output::map {

std::string input_note(const scene::file::Scene& scene, std::span<const measure::map::MapRow> rows) {
    if (scene.inputs == scene::file::Inputs::own)
        return "each format rounds the ideal scene itself: errors include what that costs (metric input_error)";
    std::vector<std::string> narrow;
    for (const measure::map::MapRow& row : rows) {
        if (!holds_shared_inputs(row.format.shape)) static_cast<void>(find_or_add(narrow, row.format.name));
    }
    if (narrow.empty()) return "";
    std::string names = narrow.front();
    for (std::size_t i = 1; i < narrow.size(); ++i) names += (i + 1 == narrow.size() ? " and " : ", ") + narrow[i];
    return fmt::format("in {} the inputs are rounded too: errors include what that costs (metric input_error)", names);
}

std::vector<std::string> sheet_subtitle(const scene::file::Scene& scene, std::span<const measure::map::MapRow> rows,
                                        const MetricPaint& paint, bool several) {
    std::vector<std::string> lines{fmt::format("{}, {} x {} rays{}", scene.id, scene.width, scene.height,
                                               paint.metric().by_run() ? "" : "; percentages are of all of them"),
                                   paint.note(several), paint.quantile_note(),
                                   rows.empty() ? "" : input_note(scene, rows)};
    std::erase(lines, "");
    return lines;
}

}  // namespace lostbits::output::map
