#include "output/map/map_sheet.hpp"

#include <fmt/format.h>

#include "output/map/map_files.hpp"
#include "output/map/sheet_words.hpp"

namespace lostbits::output::map {

using image::LegendEntry;
using measure::evaluate::EvaluationRequest;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

std::string file_word(const Metric& metric) {
    std::string word(metric.name);
    std::ranges::replace(word, ':', '.');
    return word;
}

bool is_enveloped(const MapFilesOptions& options, const Metric& drawn) {
    return options.envelope && &drawn == measure::metric::find_metric("lost_bits");
}

LegendEntry envelope_entry(const image::ColourScale& scale, std::string count) {
    return {paler_means, paler(scale.map(scale.hi() / 2)), std::move(count)};
}

std::vector<LegendEntry> possible_legend(const MapFilesOptions& options, const MetricPaint& paint,
                                         const scene::file::Scene& scene) {
    auto entries = paint.widest(scene.pixels(), scene.mesh != nullptr);
    if (is_enveloped(options, paint.metric()))
        entries.push_back(envelope_entry(*paint.scale(), fmt::format("{} (>99.9%)", scene.pixels())));
    return entries;
}

void MapSheet::open(const EvaluationRequest& request, const MapFilesOptions& options, bool first) {
    std::vector<image::ColourScale> scales;  // one a line
    for (const TestedForm& row : request.rows) {
        if (!paint.applies_to(row)) continue;
        static_cast<void>(find_or_add(forms, short_name(*row.form->info)));
        for (const Metric* m : metrics) {
            if (find_or_add(lines, line_name(row, *m)) < scales.size() || !paint.scale()) continue;
            scales.push_back(metric_scale(*m, row.format.shape, image::image_backend(), options.range));
        }
    }
    const auto differs = [&scales](const image::ColourScale& s) { return !s.is_as(scales.front()); };
    const bool several = std::ranges::any_of(scales, differs);
    if (!scales.empty() && !several) scales.resize(1, scales.front());
    const std::string name = first ? "contact.png" : fmt::format("contact.{}.png", file_word(*metrics.front()));
    page = std::make_unique<image::ContactSheet>(
        image::image_backend(), options.folder / name,
        image::SheetSpec{
            .title = request.scene->title,
            .subtitle = sheet_subtitle(*request.scene, options.named,
                                       options.listed ? std::span<const TestedForm>() : request.rows, paint, several),
            .forms = forms,
            .formats = lines,
            .field_width = request.scene->width,
            .field_height = request.scene->height,
            .scales = std::move(scales),
            .unit = std::string(paint.metric().unit),
            .legend = without_counts(possible_legend(options, paint, *request.scene)),
            .categories = !paint.scale(),
            .note_lines = cell_note_lines});
}

std::vector<MapSheet> sheets_of(const EvaluationRequest& request, const MapFilesOptions& options) {
    std::vector<MapSheet> sheets;
    for (const Metric* m : options.drawn) {
        const auto draws = [m](const TestedForm& row) {
            return MetricPaint(*m, row.format.shape, image::image_backend()).applies_to(row);
        };
        const auto first = std::ranges::find_if(request.rows, draws);
        if (first == request.rows.end()) continue;
        const auto same = std::ranges::find_if(sheets, [m](const MapSheet& s) { return s.paint.shares_with(*m); });
        if (same != sheets.end()) same->metrics.push_back(m);
        else
            sheets.push_back(
                {MetricPaint(*m, first->format.shape, image::image_backend(), options.range), {m}, nullptr, {}, {}});
    }
    for (MapSheet& sheet : sheets) {
        if (!options.keep) sheet.open(request, options, &sheet == sheets.data());
    }
    return sheets;
}

}  // namespace lostbits::output::map
