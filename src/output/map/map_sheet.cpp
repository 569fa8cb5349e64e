#include "output/map/map_sheet.hpp"

#include <fmt/format.h>

#include "output/map/map_files.hpp"
#include "output/map/sheet_words.hpp"

namespace lostbits::output::map {

using image::LegendEntry;
using measure::evaluate::EvaluationRequest;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

std::size_t index_of(const std::vector<const Metric*>& all, const Metric* one) {
    return static_cast<std::size_t>(std::ranges::find(all, one) - all.begin());
}

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
        entries.push_back(envelope_entry(*paint.scale(), pixel::widest_count(scene.pixels())));
    if (!options.sheet_alone.empty()) entries.pop_back();  // correct hits without a value
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
    const bool alone = !options.sheet_alone.empty();
    const bool several = alone ? scales.size() > 1 : std::ranges::any_of(scales, differs);
    if (!scales.empty() && !several) scales.resize(1, scales.front());
    const std::string name = first ? "contact.png" : fmt::format("contact.{}.png", file_word(*metrics.front()));
    page = std::make_unique<image::ContactSheet>(
        image::image_backend(), alone ? options.sheet_alone : options.folder / name,
        image::SheetSpec{
            .title = request.scene->title,
            .subtitle = sheet_subtitle(*request.scene, options.named,
                                       options.listed ? std::span<const TestedForm>() : request.rows, paint, several),
            .forms = forms,
            .formats = lines,
            .field_width = request.scene->width,
            .field_height = request.scene->height,
            .scales = std::move(scales),
            .unit = alone ? "lost bits" : std::string(paint.metric().unit),
            .legend = without_counts(possible_legend(options, paint, *request.scene)),
            .categories = !paint.scale(),
            .note_lines = cell_note_lines});
}

void MapSheet::finish(const EvaluationRequest& request, const std::vector<measure::evaluate::FormSummary>& summaries,
                      const MapFilesOptions& options, std::uint64_t inside) {
    pixel::CategoryCounts counts;
    std::uint64_t rays = 0;
    std::vector<SheetCell> cells;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        if (!paint.applies_to(request.rows[r])) continue;
        cells.push_back({form_of(request.rows[r]), &summaries[r]});
        for (const Metric* each : metrics) {
            const pixel::CategoryCounts of = paint.counts(summaries[r], index_of(request.metrics, each));
            counts.resize(of.size());
            std::ranges::transform(counts, of, counts.begin(), std::plus());
            rays += summaries[r].rays;
        }
    }
    if (!options.sheet_alone.empty()) counts[paint.place_of(measure::answer::Outcome::agree_hit)] = 0;
    auto legend = paint.legend(counts, rays);
    if (inside > 0 && is_enveloped(options, paint.metric())) legend.push_back(envelope_entry(*paint.scale(), ""));
    if (options.sheet_alone.empty() && !legend.empty() &&
        counts[paint.place_of(measure::answer::Outcome::agree_miss)] == rays)
        legend.front().label += ": no ray hits anything";
    page->finish(without_counts(std::move(legend)),
                 best_first(forms.size(), cells, index_of(request.metrics, measure::metric::find_metric("lost_bits"))));
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
