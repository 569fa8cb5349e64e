// The pictures of a map: of each row and metric a column of pixels, on contact sheets and alone; and what stands above
// and below them: what percentages are of, what colours and words mean, what was rounded before.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "number/format.hpp"
#include "output/map/map_colour.hpp"
#include "output/pixel/columns.hpp"
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
/// the scene to `lostbits explain`, empty for rays of a file. Without rows nothing is said of inputs.
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

struct MapFilesOptions;

/// A contact sheet: forms across; down, each format with each of the metrics that share a bar.
struct MapSheet {
    MetricPaint paint;  ///< of all its metrics, in the first format
    std::vector<const measure::metric::Metric*> metrics;
    std::vector<std::string> forms = {}, lines = {};

    [[nodiscard]] std::string line_name(const measure::evaluate::TestedForm& row,
                                        const measure::metric::Metric& metric) const {
        return metrics.size() == 1 ? row.format.name : row.format.name + " " + std::string(metric.name);
    }
};

/// Metrics that are drawn alike share a sheet. In a shard no file is opened.
class MapPictures {
public:
    /// Both must outlive it.
    MapPictures(const measure::evaluate::EvaluationRequest& request, const MapFilesOptions& options);

    /// The first of a row's pictures is also the preview's.
    [[nodiscard]] pixel::ColumnFiles<measure::evaluate::BandResult>& files() { return files_; }
    /// Draws the pages and gives the files their final names.
    void finish(const std::vector<measure::evaluate::FormSummary>& summaries);

private:
    using Column = pixel::PixelColumn<measure::evaluate::BandResult>;
    /// What a column draws.
    struct Drawing {
        std::size_t row, metric;  ///< of the request
        std::shared_ptr<const MetricPaint> paint;
        pixel::SheetPlace place;
    };
    [[nodiscard]] pixel::Pages pages();
    [[nodiscard]] std::vector<Column> add_columns();
    [[nodiscard]] Column column_of(const Drawing& drawing) const;
    [[nodiscard]] pixel::Look look_of(const Drawing& drawing) const;
    [[nodiscard]] bool is_enveloped(const measure::metric::Metric& drawn) const;
    [[nodiscard]] pixel::Sheet page_of(MapSheet& sheet) const;
    [[nodiscard]] std::string worst_words(const Drawing& drawing, const measure::evaluate::WorstRay& worst) const;
    [[nodiscard]] pixel::SheetEnd end_of(std::size_t sheet,
                                         const std::vector<measure::evaluate::FormSummary>& summaries) const;

    const measure::evaluate::EvaluationRequest& request_;
    const MapFilesOptions& options_;
    std::size_t lost_, excess_;  ///< metrics of the request; `excess_` is none without an envelope
    std::vector<MapSheet> sheets_;
    std::vector<Drawing> drawings_;  ///< one a column
    pixel::ColumnFiles<measure::evaluate::BandResult> files_;
};

}  // namespace lostbits::output::map
