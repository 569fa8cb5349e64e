// The pictures of a map: one column of pixels for each series and metric, on contact sheets and alone; and the text
// above and below them: bases of percentages, meanings of colours and words, and earlier roundings.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/map.hpp"
#include "number/format.hpp"
#include "output/map/map_colour.hpp"
#include "output/pixel/columns.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::map {

using measure::evaluate::BandResult;
using measure::evaluate::MapStudy;

/// True if the format holds every number of binary32, the format of shared inputs.
[[nodiscard]] constexpr bool holds_shared_inputs(const FloatFormat& f) {
    return f.precision >= binary32.precision && f.emax >= binary32.emax && f.emin <= binary32.emin;
}

/// Note that names the formats whose errors include the rounding of the inputs. Empty if the inputs are shared and
/// every format holds them.
[[nodiscard]] std::string input_note(const scene::file::Scene& scene, std::span<const TestedForm> rows);

/// Facts that the lines below the title of a contact sheet state.
struct SheetSubject {
    const scene::file::Scene& scene;
    std::string scene_arguments;       ///< see `MapFilesOptions`; empty for rays of a file
    std::span<const TestedForm> rows;  ///< empty: no line is about the inputs
    const MetricPaint& paint;
    bool has_several_bars = false;      ///< the sheet has several colour bars
    bool zooms = false;                 ///< the cells enlarge the worst pixel
    std::string explaining_sheet = {};  ///< see `MapFilesOptions`
};
[[nodiscard]] std::vector<std::string> sheet_subtitle(const SheetSubject& sheet);

/// Lines below a cell: four of the `short_summary`, and one that names the worst pixel.
inline constexpr std::size_t cell_note_lines = 5;
/// Text below a cell of a sheet: the `short_summary` of the metric, and `worst pixel 100,90` if a ray is worse than
/// another.
[[nodiscard]] std::string cell_note(const MetricPaint& paint, const FormSummary& summary, std::size_t m);

/// Result of a form in the first format of a sheet.
struct SheetCell {
    std::size_t form;
    const FormSummary* summary;
};
/// Order of `forms` forms: fewest wrong decisions first, then the least p99 of lost bits (metric `lost_bits_index` of
/// the request), then the given order. If a form has several cells, the first one counts.
[[nodiscard]] std::vector<std::size_t> best_first(std::size_t forms, std::span<const SheetCell> cells,
                                                  std::size_t lost_bits_index);

struct MapFilesOptions;

/// A contact sheet: forms across; down, each format with each of the metrics that share a bar.
struct MapSheet {
    MetricPaint paint;  ///< for all its metrics, in the first format
    std::vector<const Metric*> metrics;
    std::vector<std::string> forms = {}, lines = {};

    [[nodiscard]] std::string line_name(const TestedForm& form_row, const Metric& metric) const {
        return metrics.size() == 1 ? form_row.format.name : form_row.format.name + " " + std::string(metric.name);
    }
};

/// Draws the pictures. Metrics that are drawn alike share a sheet. A shard opens no file.
class MapPictures {
public:
    /// Both arguments must outlive the object.
    MapPictures(const MapStudy& request, const MapFilesOptions& options);

    /// Files of the columns. The first picture of a row is also its preview.
    [[nodiscard]] pixel::ColumnFiles<BandResult>& files() { return files_; }
    /// Draws the pages and gives the files their final names.
    void finish(const std::vector<FormSummary>& summaries);

private:
    using Column = pixel::PixelColumn<BandResult>;
    /// The subject of a column.
    struct Drawing {
        std::size_t row, metric;  ///< indices in the request
        std::shared_ptr<const MetricPaint> paint;
        pixel::SheetPosition position;
    };
    [[nodiscard]] pixel::Pages pages();
    [[nodiscard]] std::vector<Column> add_columns();
    [[nodiscard]] Column column_of(const Drawing& drawing) const;
    [[nodiscard]] pixel::Look look_of(const Drawing& drawing) const;
    [[nodiscard]] bool is_enveloped(const Metric& metric) const;
    [[nodiscard]] pixel::Sheet page_of(MapSheet& sheet) const;
    [[nodiscard]] bool zooms(const MetricPaint& paint) const;
    [[nodiscard]] std::string worst_pixel_text(const Drawing& drawing, const measure::evaluate::WorstRay& worst) const;
    [[nodiscard]] pixel::SheetEnd end_of(std::size_t sheet, const std::vector<FormSummary>& summaries) const;

    const MapStudy& request_;
    const MapFilesOptions& options_;
    std::size_t lost_bits_index_,
        excess_index_;  ///< indices of metrics in the request; the index of a missing metric is the number of metrics
    std::vector<MapSheet> sheets_;
    std::vector<Drawing> drawings_;  ///< one per column
    pixel::ColumnFiles<BandResult> files_;
};

}  // namespace lostbits::output::map
