// The contact sheets of a map, and the legends that they share with its heatmaps.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/map/metric_paint.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::map {

struct MapFilesOptions;

std::size_t index_of(const std::vector<const measure::metric::Metric*>& all, const measure::metric::Metric* one);

/// `contribution.c`: a metric's name where no colon may be.
std::string file_word(const measure::metric::Metric& metric);

/// Whether the pictures of a metric are drawn paler where the problem explains them.
bool is_enveloped(const MapFilesOptions& options, const measure::metric::Metric& drawn);
image::LegendEntry envelope_entry(const image::ColourScale& scale, std::string count);

/// Every class that may occur, with the widest count, in a picture of the scene.
std::vector<image::LegendEntry> possible_legend(const MapFilesOptions& options, const MetricPaint& paint,
                                                const scene::file::Scene& scene);

/// A contact sheet: forms across; down, each format with each of the metrics that share a bar.
struct MapSheet {
    MetricPaint paint;  ///< of all its metrics, in the first format
    std::vector<const measure::metric::Metric*> metrics;
    std::unique_ptr<image::ContactSheet> page;
    std::vector<std::string> forms, lines;

    [[nodiscard]] std::size_t form_of(const measure::evaluate::TestedForm& row) const {
        return place(forms, short_name(*row.form->info));
    }
    [[nodiscard]] std::size_t line_of(const measure::evaluate::TestedForm& row,
                                      const measure::metric::Metric& metric) const {
        return place(lines, line_name(row, metric));
    }
    [[nodiscard]] std::string line_name(const measure::evaluate::TestedForm& row,
                                        const measure::metric::Metric& metric) const {
        return metrics.size() == 1 ? row.format.name : row.format.name + " " + std::string(metric.name);
    }
    static std::size_t place(const std::vector<std::string>& names, const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    }

    void open(const measure::evaluate::EvaluationRequest& request, const MapFilesOptions& options, bool first);
    /// Draws the page, of which so many pixels are paler, and gives the file its name.
    void finish(const measure::evaluate::EvaluationRequest& request,
                const std::vector<measure::evaluate::FormSummary>& summaries, const MapFilesOptions& options,
                std::uint64_t inside);
};

/// Metrics that are drawn alike share a sheet. None is opened in a shard.
std::vector<MapSheet> sheets_of(const measure::evaluate::EvaluationRequest& request, const MapFilesOptions& options);

}  // namespace lostbits::output::map
