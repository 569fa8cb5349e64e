#include "output/map/scene_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/contact_sheet.hpp"
#include "output/map/metric_paint.hpp"
#include "output/map/row_names.hpp"
#include "output/map/sheet_words.hpp"

namespace lostbits::output::map {

using image::ColourScale;
using image::ContactSheet;
using measure::evaluate::EvaluationSink;

namespace {

/// Hands a row's lost bits on to the contact sheet.
class SheetRow final : public EvaluationSink {
public:
    SheetRow(ContactSheet& sheet, RowGrid::Place place, MetricPaint paint, std::size_t metric)
        : sheet_(sheet), place_(place), paint_(std::move(paint)), metric_(metric) {}
    void band(const measure::evaluate::BandResult& result) override {
        std::vector<image::Rgb8> field(result.outcomes.size());
        for (std::size_t i = 0; i < field.size(); ++i)
            field[i] = paint_.colour(result.outcomes[i], result.metrics[metric_][i]);
        sheet_.add_rows(place_.form, place_.format, result.y0, field);
    }
    void finish(const measure::evaluate::FormSummary& summary) {
        sheet_.set_note(place_.form, place_.format, cell_note(paint_, summary, metric_));
    }

private:
    ContactSheet& sheet_;
    RowGrid::Place place_;
    MetricPaint paint_;
    std::size_t metric_;
};

}  // namespace

struct SceneSheet::Parts {
    std::size_t metric;
    RowGrid grid;
    std::unique_ptr<ContactSheet> sheet;
    std::vector<std::unique_ptr<SheetRow>> rows;
};

SceneSheet::SceneSheet(const measure::evaluate::EvaluationRequest& request, const std::filesystem::path& path,
                       const std::string& named) {
    const measure::metric::Metric* const lost = measure::metric::find_metric("lost_bits");
    image::ImageBackend& backend = image::image_backend();
    const auto metric = static_cast<std::size_t>(std::ranges::find(request.metrics, lost) - request.metrics.begin());
    parts_ = std::unique_ptr<Parts>(new Parts{metric, RowGrid(request.rows), nullptr, {}});
    Parts& p = *parts_;
    const scene::file::Scene& scene = *request.scene;
    std::vector<ColourScale> scales;  // one a format
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        if (p.grid.places[r].format < scales.size()) continue;
        scales.push_back(metric_scale(*lost, request.rows[r].format.shape, backend));
    }
    const MetricPaint first(*lost, request.rows.front().format.shape, backend);
    const bool several = scales.size() > 1;
    p.sheet = std::make_unique<ContactSheet>(
        backend, path,
        image::SheetSpec{.title = scene.title,
                         .subtitle = sheet_subtitle(scene, named, request.rows, first, several),
                         .forms = p.grid.forms,
                         .formats = p.grid.formats,
                         .field_width = scene.width,
                         .field_height = scene.height,
                         .scales = std::move(scales),
                         .unit = "lost bits",
                         .legend = without_counts(widest_legend(scene.pixels(), scene.mesh != nullptr)),
                         .note_lines = cell_note_lines});
    for (std::size_t r = 0; r < request.rows.size(); ++r)
        p.rows.push_back(std::make_unique<SheetRow>(*p.sheet, p.grid.places[r],
                                                    MetricPaint(*lost, request.rows[r].format.shape, backend), metric));
}

SceneSheet::~SceneSheet() = default;

std::vector<EvaluationSink*> SceneSheet::sinks() {
    std::vector<EvaluationSink*> all;
    for (const auto& row : parts_->rows) all.push_back(row.get());
    return all;
}

void SceneSheet::finish(const std::vector<measure::evaluate::FormSummary>& summaries) {
    Parts& p = *parts_;
    measure::evaluate::FormSummary total;
    std::vector<SheetCell> cells;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        total.rays += summaries[r].rays;
        for (std::size_t o = 0; o < total.outcomes.size(); ++o) total.outcomes[o] += summaries[r].outcomes[o];
        p.rows[r]->finish(summaries[r]);
        cells.push_back({p.grid.places[r].form, &summaries[r]});
    }
    p.sheet->finish(without_counts(outcome_legend(total)), best_first(p.grid.forms.size(), cells, p.metric));
}

}  // namespace lostbits::output::map
