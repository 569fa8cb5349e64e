#include "output/map/scene_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/contact_sheet.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::output::map {

using image::ColourScale;
using image::ContactSheet;
using measure::map::MapSink;

namespace {

/// Hands a row's lost bits on to the contact sheet.
class SheetRow final : public MapSink {
public:
    SheetRow(ContactSheet& sheet, std::size_t form, std::size_t format, const ColourScale& scale, std::size_t metric)
        : sheet_(sheet), form_(form), format_(format), scale_(scale), metric_(metric) {}
    void band(const measure::map::BandResult& result) override {
        std::vector<image::Rgb8> field(result.outcomes.size());
        for (std::size_t i = 0; i < field.size(); ++i)
            field[i] = pixel_colour(scale_, result.outcomes[i], result.metrics[metric_][i]);
        sheet_.add_rows(form_, format_, result.y0, field);
    }

private:
    ContactSheet& sheet_;
    std::size_t form_, format_;
    const ColourScale& scale_;
    std::size_t metric_;
};

struct Place {
    std::size_t form, format;
};

}  // namespace

struct SceneSheet::Parts {
    std::size_t metric;
    ColourScale scale;
    std::vector<Place> places;
    std::unique_ptr<ContactSheet> sheet;
    std::vector<std::unique_ptr<SheetRow>> rows;
};

SceneSheet::SceneSheet(const measure::map::MapRequest& request, const std::filesystem::path& path) {
    const measure::metric::Metric* const lost = measure::metric::find_metric("lost_bits");
    image::ImageBackend& backend = image::image_backend();
    const auto metric = static_cast<std::size_t>(std::ranges::find(request.metrics, lost) - request.metrics.begin());
    parts_ = std::unique_ptr<Parts>(new Parts{metric, metric_scale(*lost, request.rows, backend), {}, nullptr, {}});
    Parts& p = *parts_;
    std::vector<std::string> forms, formats;
    const auto place = [](std::vector<std::string>& names, const std::string& one) {
        const auto at = std::ranges::find(names, one) - names.begin();
        if (static_cast<std::size_t>(at) == names.size()) names.push_back(one);
        return static_cast<std::size_t>(at);
    };
    for (const measure::map::MapRow& r : request.rows) {
        const auto full = r.form->info->name;
        const std::size_t form = place(forms, std::string(full.substr(full.find('.') + 1)));
        p.places.push_back({form, place(formats, r.format.name)});
    }
    const scene::file::Scene& scene = *request.scene;
    const auto pixels = static_cast<std::uint64_t>(scene.width) * static_cast<std::uint64_t>(scene.height);
    p.sheet = std::make_unique<ContactSheet>(
        backend, path,
        image::SheetSpec{.title = scene.title,
                         .subtitle = {fmt::format("{}, {} x {} rays", scene.id, scene.width, scene.height)},
                         .forms = forms,
                         .formats = formats,
                         .field_width = scene.width,
                         .field_height = scene.height,
                         .scale = p.scale,
                         .unit = "lost bits",
                         .legend = widest_legend(pixels * request.rows.size())});
    for (const auto& [form, format] : p.places)
        p.rows.push_back(std::make_unique<SheetRow>(*p.sheet, form, format, p.scale, metric));
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
        p.sheet->set_note(p.places[r].form, p.places[r].format,
                          fmt::format("p99 {:.1f} bits lost", summaries[r].metrics[p.metric].quantile(0.99)));
    }
    p.sheet->finish(outcome_legend(total));
}

}  // namespace lostbits::output::map
