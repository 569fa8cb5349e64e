// The pictures of a map: of each row and metric a column of pixels, on contact sheets and alone.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/map/metric_paint.hpp"
#include "output/pixel/columns.hpp"

namespace lostbits::output::map {

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

    /// Of each of a row's pictures, the first of which is also the preview's.
    [[nodiscard]] std::vector<pixel::Strip> draw(std::size_t row, const measure::evaluate::BandResult& band) const {
        return files_.draw(row, band, band.outcomes.size());
    }
    void put(std::size_t row, int y0, const std::vector<pixel::Strip>& strips) { files_.put(row, y0, strips); }
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
