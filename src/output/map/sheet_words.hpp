// What stands above pictures of maps: what percentages are of, what colours and words mean, what was rounded before.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "number/format.hpp"
#include "output/map/metric_paint.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::map {

/// Whether the format holds every number of binary32, as which shared inputs are stored.
[[nodiscard]] constexpr bool holds_shared_inputs(const FloatFormat& f) {
    return f.precision >= binary32.precision && f.emax >= binary32.emax && f.emin <= binary32.emin;
}

/// Says of which formats of the rows the errors include what rounding the inputs costs. Empty where they are shared and
/// every format holds them.
[[nodiscard]] std::string input_note(const scene::file::Scene& scene,
                                     std::span<const measure::evaluate::TestedForm> rows);

/// The lines below the title of a contact sheet, on which one metric has `several` bars or not; `named` is what names
/// the scene to `lostbits explain`. Without rows nothing is said of inputs.
[[nodiscard]] std::vector<std::string> sheet_subtitle(const scene::file::Scene& scene, const std::string& named,
                                                      std::span<const measure::evaluate::TestedForm> rows,
                                                      const MetricPaint& paint, bool several);

/// Four of a glance, and one that names the worst pixel.
inline constexpr std::size_t cell_note_lines = 5;
/// What stands below a cell of a sheet: a glance, and `worst pixel 100,90`, where a ray is worse than another.
[[nodiscard]] std::string cell_note(const MetricPaint& paint, const measure::evaluate::FormSummary& summary,
                                    std::size_t m);

/// What was found of a form, in the format that a sheet has first.
struct SheetCell {
    std::size_t form;
    const measure::evaluate::FormSummary* summary;
};
/// So many forms by fewest wrong decisions, then by the least p99 of lost bits (metric `lost` of the request), as they
/// came where both are the same. Of several cells of a form the first counts.
[[nodiscard]] std::vector<std::size_t> best_first(std::size_t forms, std::span<const SheetCell> cells,
                                                  std::size_t lost);

}  // namespace lostbits::output::map
