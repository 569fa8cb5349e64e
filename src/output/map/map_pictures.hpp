// The pictures of a map, on contact sheets and alone: one column of pixels for each form in a format and metric. Also
// the text above and below them: what percentages are of, what colours and words mean, and which inputs were rounded
// before.
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
[[nodiscard]] constexpr bool holds_shared_inputs(const FloatFormat& format) {
    return format.precision >= binary32.precision && format.emax >= binary32.emax && format.emin <= binary32.emin;
}

/// Note that names the formats whose errors include the rounding of the inputs. Empty if the inputs are shared and
/// every format holds them.
[[nodiscard]] std::string input_note(const scene::file::Scene& scene, std::span<const TestedForm> tested_forms);

/// Facts for the lines below the title of a contact sheet.
struct SheetSubject {
    const scene::file::Scene& scene;
    std::string scene_arguments;               ///< see `MapFilesOptions`; empty for rays of a file
    std::span<const TestedForm> tested_forms;  ///< empty: no line is about the inputs
    const MetricPaint& paint;
    bool has_several_bars = false;             ///< the sheet has several colour bars
    bool zooms = false;                        ///< the cells enlarge the worst pixel
    std::string sheet_with_explanations = {};  ///< see `MapFilesOptions`
};
/// Lines below the title of a contact sheet.
[[nodiscard]] std::vector<std::string> sheet_subtitle(const SheetSubject& sheet);

/// Lines below a cell: four of the `short_summary`, and one that names the worst pixel.
inline constexpr std::size_t cell_note_lines = 5;
/// Text below a cell of a sheet: the `short_summary` of the metric and, if one ray is worse than the others, `worst
/// pixel 100,90`.
[[nodiscard]] std::string cell_note(const MetricPaint& paint, const FormSummary& summary, std::size_t metric_index);

/// Result of a form in the first format of a sheet.
struct SheetCell {
    std::size_t form_index;
    const FormSummary* summary;
};
/// Order of forms on a sheet: fewest wrong decisions first, then the least p99 of lost bits, whose metric has the index
/// `lost_bits_index` in the study. Equal forms keep their order. If a form has several cells, the first one counts.
[[nodiscard]] std::vector<std::size_t> best_first(std::size_t form_count, std::span<const SheetCell> cells,
                                                  std::size_t lost_bits_index);

struct MapFilesOptions;

/// A contact sheet. Its columns are forms; its lines are each format with each of the metrics that share a colour bar.
struct MapSheet {
    MetricPaint paint;  ///< for all its metrics, in the first format
    std::vector<const Metric*> metrics;
    std::vector<std::string> forms = {}, lines = {};

    [[nodiscard]] std::string line_name(const TestedForm& tested_form, const Metric& metric) const {
        return metrics.size() == 1 ? tested_form.format.name : tested_form.format.name + " " + std::string(metric.name);
    }
};

/// Draws the pictures. Metrics that are drawn alike share a sheet. A shard opens no file.
class MapPictures {
public:
    /// Both arguments must outlive the object.
    MapPictures(const MapStudy& study, const MapFilesOptions& options);

    /// Files of the columns. The first picture of a form in a format is also its preview.
    [[nodiscard]] pixel::PictureWriter<BandResult>& files() { return files_; }
    /// Draws the sheets and gives the files their final names.
    void finish(const std::vector<FormSummary>& summaries);

private:
    using Column = pixel::DrawnColumn<BandResult>;
    /// Subject of a column: a metric of a form in a format, and its cell on a sheet.
    struct Drawing {
        std::size_t form_index, metric_index;  ///< in the study
        std::shared_ptr<const MetricPaint> paint;
        pixel::SheetPosition position;
    };
    [[nodiscard]] pixel::PictureFiles describe_files();
    [[nodiscard]] std::vector<Column> make_columns();
    [[nodiscard]] Column make_column(const Drawing& drawing) const;
    [[nodiscard]] pixel::Look make_look(const Drawing& drawing) const;
    [[nodiscard]] bool draws_envelope_of(const Metric& metric) const;
    [[nodiscard]] pixel::SheetFile describe_sheet(MapSheet& sheet) const;
    [[nodiscard]] bool zooms(const MetricPaint& paint) const;
    [[nodiscard]] std::string worst_pixel_text(const Drawing& drawing, const measure::evaluate::WorstRay& worst) const;
    [[nodiscard]] pixel::FinishedSheet describe_finished_sheet(std::size_t sheet,
                                                               const std::vector<FormSummary>& summaries) const;

    const MapStudy& study_;
    const MapFilesOptions& options_;
    /// Indices of metrics in the study. The index of a missing metric is the number of metrics.
    std::size_t lost_bits_index_, excess_index_;
    std::vector<MapSheet> sheets_;
    std::vector<Drawing> drawings_;  ///< one per column
    pixel::PictureWriter<BandResult> files_;
};

}  // namespace lostbits::output::map
