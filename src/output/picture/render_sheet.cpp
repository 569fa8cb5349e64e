#include "output/picture/render_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/map/sheet_words.hpp"
#include "output/picture/render_colour.hpp"

namespace lostbits::output::picture {

namespace {

std::string percent(std::uint64_t part, std::uint64_t whole) {
    const double share = 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    return share > 0 && share < 0.1 ? std::string("<0.1%") : fmt::format("{:.1f}%", share);
}

constexpr const char* glance_means =
    "wrong colour: a byte is not that of the certified picture; wrong sphere: another one is seen, none where there is "
    "one, or one where there is none";

/// The note under a thumbnail: what a glance should take away.
std::string glance(const measure::picture::RenderSummary& s) {
    std::string text = s.changed == 0 ? "every pixel right" : percent(s.changed, s.pixels) + " wrong colour";
    if (const std::uint64_t wrong = s.seen_wrong()) text += fmt::format("\n{} wrong sphere", percent(wrong, s.pixels));
    if (!s.rule.shadows) return text;
    const auto acne = s.count(false, measure::picture::Shadow::own_shadow);
    if (acne > 0) text += fmt::format("\n{} acne", percent(acne, s.pixels));
    if (const auto flips = s.flips()) text += fmt::format("{}{} shadow flips", acne > 0 ? ", " : "\n", flips);
    return text;
}

}  // namespace

RenderSheet::RenderSheet(image::ImageBackend& backend, const std::filesystem::path& path,
                         const measure::picture::RenderRequest& request)
    : request_(request), grid_(request.rows) {
    const scene::file::Scene& scene = *request.scene;
    image::SheetSpec spec{
        .title = scene.title,
        .subtitle = {fmt::format("{}, {} x {} pixels; percentages are of all of them", scene.id, scene.width,
                                 scene.height),
                     "the picture of each form in each format, beside the certified one", glance_means},
        .forms = {"certified"},
        .formats = {},
        .field_width = scene.width,
        .field_height = scene.height,
        .scales = {},
        .unit = "",
        .legend = {{"not a number", nan_colour, ""}, {"colour not proved", unproved_colour, ""}}};
    if (std::string note = map::input_note(scene, request.rows); !note.empty())
        spec.subtitle.push_back(std::move(note));
    spec.forms.insert(spec.forms.end(), grid_.forms.begin(), grid_.forms.end());
    for (const scene::file::Stage stage : request.stages) {
        for (const std::string& format : grid_.formats)
            spec.formats.push_back(fmt::format("{}, {}", name_of(stage), format));
    }
    sheet_.emplace(backend, path, std::move(spec));
}

void RenderSheet::reference(int y0, int, std::span<const measure::picture::TruePixel> truth) {
    std::vector<image::Rgb8> field(truth.size());
    for (std::size_t s = 0; s < request_.stages.size(); ++s) {
        const auto stage = static_cast<std::size_t>(request_.stages[s]);
        std::ranges::transform(truth, field.begin(), [stage](const measure::picture::TruePixel& p) {
            return picture_colour(p.colours[stage]);
        });
        for (std::size_t f = 0; f < grid_.formats.size(); ++f) sheet_->add_rows(0, line(s, f), y0, field);
    }
}

void RenderSheet::row(std::size_t row, const measure::picture::RenderBand& band) {
    std::vector<image::Rgb8> field(band.seen.size());
    for (std::size_t s = 0; s < request_.stages.size(); ++s) {
        std::ranges::transform(band.painted[s], field.begin(),
                               [](const measure::picture::Painted& p) { return picture_colour(p); });
        sheet_->add_rows(column(row), line(s, grid_.places[row].format), band.y0, field);
    }
}

void RenderSheet::finish(const std::vector<measure::picture::RenderSummary>& summaries) {
    const std::size_t stages = request_.stages.size();
    bool any_nan = false, any_unproved = false;
    for (std::size_t k = 0; k < summaries.size(); ++k) {
        sheet_->set_note(column(k / stages), line(k % stages, grid_.places[k / stages].format), glance(summaries[k]));
        any_nan |= summaries[k].colour_not_a_number > 0;
        any_unproved |= summaries[k].unresolved() > 0;
    }
    std::vector<image::LegendEntry> legend;
    if (any_nan) legend.push_back({"not a number", nan_colour, ""});
    if (any_unproved) legend.push_back({"colour not proved", unproved_colour, ""});
    sheet_->finish(legend);
}

}  // namespace lostbits::output::picture
