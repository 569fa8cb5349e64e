// What stands above pictures of maps: what percentages are of, what colours and words mean, what was rounded before.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/map/map.hpp"
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
[[nodiscard]] std::string input_note(const scene::file::Scene& scene, std::span<const measure::map::MapRow> rows);

/// The lines below the title of a contact sheet, on which one metric has `several` bars or not. Without rows nothing is
/// said of inputs.
[[nodiscard]] std::vector<std::string> sheet_subtitle(const scene::file::Scene& scene,
                                                      std::span<const measure::map::MapRow> rows,
                                                      const MetricPaint& paint, bool several);

}  // namespace lostbits::output::map
