#include "output/map/scene_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/contact_sheet.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::map {

using image::ColourScale;
using image::ContactSheet;
using measure::map::MapSink;

namespace {

/// Hands a row's lost bits on to the contact sheet.
class SheetRow final : public MapSink {
public:
    SheetRow(ContactSheet& sheet, RowGrid::Place place, const ColourScale& scale, std::size_t metric)
        : sheet_(sheet), place_(place), scale_(scale), metric_(metric) {}
    void band(const measure::map::BandResult& result) override {
        std::vector<image::Rgb8> field(result.outcomes.size());
        for (std::size_t i = 0; i < field.size(); ++i)
            field[i] = pixel_colour(scale_, result.outcomes[i], result.metrics[metric_][i]);
        sheet_.add_rows(place_.form, place_.format, result.y0, field);
    }

private:
    ContactSheet& sheet_;
    RowGrid::Place place_;
    const ColourScale& scale_;
    std::size_t metric_;
};

}  // namespace

struct SceneSheet::Parts {
    std::size_t metric;
    ColourScale scale;
    RowGrid grid;
    std::unique_ptr<ContactSheet> sheet;
    std::vector<std::unique_ptr<SheetRow>> rows;
};

SceneSheet::SceneSheet(const measure::map::MapRequest& request, const std::filesystem::path& path) {
    const measure::metric::Metric* const lost = measure::metric::find_metric("lost_bits");
    image::ImageBackend& backend = image::image_backend();
    const auto metric = static_cast<std::size_t>(std::ranges::find(request.metrics, lost) - request.metrics.begin());
    parts_ = std::unique_ptr<Parts>(
        new Parts{metric, metric_scale(*lost, request.rows, backend), RowGrid(request.rows), nullptr, {}});
    Parts& p = *parts_;
    const scene::file::Scene& scene = *request.scene;
    p.sheet = std::make_unique<ContactSheet>(
        backend, path,
        image::SheetSpec{.title = scene.title,
                         .subtitle = {fmt::format("{}, {} x {} rays", scene.id, scene.width, scene.height)},
                         .forms = p.grid.forms,
                         .formats = p.grid.formats,
                         .field_width = scene.width,
                         .field_height = scene.height,
                         .scale = p.scale,
                         .unit = "lost bits",
                         .legend = widest_legend(scene.pixels() * request.rows.size())});
    for (const RowGrid::Place& place : p.grid.places)
        p.rows.push_back(std::make_unique<SheetRow>(*p.sheet, place, p.scale, metric));
}

SceneSheet::~SceneSheet() = default;

std::vector<MapSink*> SceneSheet::sinks() {
    std::vector<MapSink*> all;
    for (const auto& row : parts_->rows) all.push_back(row.get());
    return all;
}

void SceneSheet::finish(const std::vector<measure::map::MapSummary>& summaries) {
    Parts& p = *parts_;
    measure::map::MapSummary total;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        total.rays += summaries[r].rays;
        for (std::size_t o = 0; o < total.outcomes.size(); ++o) total.outcomes[o] += summaries[r].outcomes[o];
        p.sheet->set_note(p.grid.places[r].form, p.grid.places[r].format,
                          fmt::format("p99 {:.1f} bits lost", summaries[r].metrics[p.metric].quantile(0.99)));
    }
    p.sheet->finish(outcome_legend(total));
}

}  // namespace lostbits::output::map
