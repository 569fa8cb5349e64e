#include "output/map/map_files.hpp"

#include <fmt/format.h>

#include <optional>

#include "intersect/process/parallel.hpp"
#include "output/blame/explain_command.hpp"
#include "output/file/machine.hpp"
#include "output/image/heatmap.hpp"
#include "output/map/culprit_table.hpp"
#include "output/map/map_sheet.hpp"
#include "output/map/map_tables.hpp"
#include "output/map/metric_paint.hpp"
#include "output/map/row_names.hpp"
#include "output/map/sheet_words.hpp"

namespace lostbits::output::map {

using file::CsvWriter;
using measure::evaluate::EvaluationRequest;
using measure::evaluate::EvaluationSink;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

/// The files of one row.
class RowFiles final : public EvaluationSink {
public:
    struct Drawing {
        std::size_t metric;
        MetricPaint paint;
        MapSheet* sheet;
        bool enveloped;
        std::unique_ptr<image::HeatmapWriter> heatmap;
    };

    RowFiles(const EvaluationRequest& request, const TestedForm& row, const MapFilesOptions& options,
             image::ImageBackend& backend, std::vector<MapSheet>& sheets)
        : request_(request),
          row_(row),
          exr_(options.exr),
          pixels_(options.pixels_csv),
          keep_(options.keep),
          pixel_table_(pixel_table(request.metrics)),
          named_(options.named),
          lost_(index_of(request.metrics, measure::metric::find_metric("lost_bits"))),
          excess_(index_of(request.metrics, measure::metric::find_metric("excess_bits"))) {
        const std::string stem = row_name(row);
        for (const Metric* m : options.drawn) {
            MapSheet& sheet = *std::ranges::find_if(
                sheets, [m](const MapSheet& s) { return std::ranges::find(s.metrics, m) != s.metrics.end(); });
            const MetricPaint paint(*m, row.format.shape, backend, options.range);
            if (!paint.applies_to(row)) continue;
            drawings_.push_back({index_of(request.metrics, m), paint, &sheet, is_enveloped(options, *m), nullptr});
            if (options.singles && !keep_)
                drawings_.back().heatmap = std::make_unique<image::HeatmapWriter>(
                    backend, options.folder / (stem + (options.drawn.size() == 1 ? "" : "." + file_word(*m)) + ".png"),
                    heatmap_spec(*m, paint, options));
        }
        if (options.pixels_csv && !keep_)
            csv_.emplace(options.folder, stem + ".csv",
                         fmt::format("One row per pixel: {} in {}", row.form->info->name, row.format.name),
                         pixel_table_);
    }

    void band(const measure::evaluate::BandResult& result) override {
        MapPiece piece = piece_of(result);
        if (keep_) keep_(static_cast<std::size_t>(&row_ - request_.rows.data()), std::move(piece));
        else put(piece);
    }

    void put(const MapPiece& piece) {
        for (std::size_t k = 0; k < drawings_.size(); ++k) {
            Drawing& d = drawings_[k];
            if (d.heatmap) d.heatmap->write_rows(piece.fields.at(k));
            d.sheet->page->add_rows(d.sheet->form_of(row_), d.sheet->line_of(row_, d.paint.metric()), piece.y0,
                                    piece.fields.at(k));
        }
        paler_ += piece.paler;
        if (exr_) exr_->write(piece.exr);
        if (csv_) csv_->add_lines(piece.lines);
    }

    void finish(const FormSummary& summary) {
        for (Drawing& d : drawings_) {
            const measure::evaluate::WorstRay* const worst = summary.worst_ray();
            if (d.heatmap) {
                auto legend = d.paint.legend(d.paint.counts(summary, d.metric), summary.rays);
                if (d.enveloped && paler_ > 0)
                    legend.push_back(envelope_entry(*d.paint.scale(), pixel::count_text(paler_, summary.rays)));
                d.heatmap->finish(legend,
                                  d.paint.caption(summary, d.metric) + (worst ? worst_words(d.paint, *worst) : ""));
            }
            d.sheet->page->set_note(d.sheet->form_of(row_), d.sheet->line_of(row_, d.paint.metric()),
                                    cell_note(d.paint, summary, d.metric));
        }
        if (csv_) csv_->close();
    }

    /// Of its pixels, where there is one.
    [[nodiscard]] const std::optional<table::TableFile<BandRay>>& table() const { return csv_; }
    /// Pixels drawn paler, in any of the pictures of lost bits.
    [[nodiscard]] std::uint64_t inside() const { return paler_; }

private:
    [[nodiscard]] image::HeatmapSpec heatmap_spec(const Metric& m, const MetricPaint& paint,
                                                  const MapFilesOptions& options) const {
        const scene::file::Scene& scene = *request_.scene;
        image::HeatmapSpec spec{
            .title =
                fmt::format("{} in {}: {}{}", row_.form->info->name, row_.format.name, m.name,
                            m.over == measure::metric::Over::pairs ? fmt::format(" {}", row_.against->info->name) : ""),
            .subtitle = {scene.title, title_of(*row_.form->info), paint.note()},
            .width = scene.width,
            .height = scene.height,
            .scale = paint.scale(),
            .unit = std::string(m.unit),
            .legend = possible_legend(options, paint, scene),
            .widest_caption =
                paint.widest_caption(scene.pixels()) + worst_words(paint, {.x = scene.width, .y = scene.height})};
        if (std::string note = input_note(scene, std::span(&row_, 1)); !note.empty() && !options.listed)
            spec.subtitle.push_back(std::move(note));
        return spec;
    }

    [[nodiscard]] MapPiece piece_of(const measure::evaluate::BandResult& result) const {
        MapPiece piece{.y0 = result.y0};
        for (const Drawing& d : drawings_) {
            std::vector<image::Rgb8>& field = piece.fields.emplace_back(result.outcomes.size());
            // In places of their own: a colour is bytes, and for all the compiler knows they lie anywhere.
            const std::span<const measure::answer::Outcome> outcomes = result.outcomes;
            const std::span<const double> values = result.metrics[d.metric];
            image::Rgb8* const at = field.data();
            for (std::size_t i = 0; i < outcomes.size(); ++i) at[i] = d.paint.colour(outcomes[i], values[i]);
            if (d.enveloped) piece.paler += draw_envelope(result, field);
        }
        if (exr_) piece.exr = exr_->rows_of(row_, result, drawings_.empty() ? outcomes_of(result) : piece.fields[0]);
        if (pixels_) {
            CsvWriter lines(pixel_table_.columns());
            for (std::size_t i = 0; i < result.outcomes.size(); ++i) pixel_table_.add_row(lines, {&result, i, &row_});
            piece.lines = lines.take_lines();
        }
        return piece;
    }

    /// `; worst pixel 100,90: lostbits explain near-benign --pixel 100,90 -i sphere.press -f f32`; a form that is
    /// compiled elsewhere leaves nothing to explain.
    [[nodiscard]] std::string worst_words(const MetricPaint& paint, const measure::evaluate::WorstRay& worst) const {
        if (!paint.names_worst()) return "";
        const std::string place = fmt::format("; worst pixel {},{}", worst.x, worst.y);
        if (!row_.form->record) return place;
        return place + ": " +
               blame::explain_command(blame::name_of_pixel(named_, static_cast<int>(worst.x), worst.y), row_);
    }

    /// The preview of a row that none of the metrics applies to.
    static std::vector<image::Rgb8> outcomes_of(const measure::evaluate::BandResult& result) {
        std::vector<image::Rgb8> field(result.outcomes.size());
        for (std::size_t i = 0; i < field.size(); ++i) field[i] = pixel::colour_of(result.outcomes[i]);
        return field;
    }

    /// How many pixels it draws paler. NaN, where a metric does not exist, is inside nothing.
    std::uint64_t draw_envelope(const measure::evaluate::BandResult& result, std::vector<image::Rgb8>& field) const {
        std::uint64_t inside = 0;
        for (std::size_t i = 0; i < field.size(); ++i) {
            if (!inside_envelope(result.metrics[lost_][i], result.metrics[excess_][i])) continue;
            field[i] = paler(field[i]);
            ++inside;
        }
        return inside;
    }

    const EvaluationRequest& request_;
    const TestedForm& row_;
    MapExr* exr_;
    bool pixels_;
    const KeepPiece& keep_;
    table::Table<BandRay> pixel_table_;
    const std::string& named_;
    std::size_t lost_, excess_;  ///< metrics of the request; `excess_` is none without an envelope
    std::uint64_t paler_ = 0;
    std::vector<Drawing> drawings_;
    std::optional<table::TableFile<BandRay>> csv_;
};

struct MapFiles::Parts {
    const EvaluationRequest& request;
    MapFilesOptions options;
    std::vector<MapSheet> sheets = {};
    std::vector<std::unique_ptr<RowFiles>> rows = {};
    std::optional<table::TableFile<SummaryRow>> summary = {};
    std::optional<table::TableFile<Culprit>> culprits = {};

    [[nodiscard]] table::Table<SummaryRow> summary_columns() const {
        auto table =
            summary_table(request.metrics, request.scene->shapes(), request.scene->mesh != nullptr, options.by);
        if (!options.listed) return table;
        for (auto& c : table)
            if (c.about.unit == "pixel") c.about.unit = "";
        table.set_meaning("rays", "rays of the file");
        table.set_meaning("worst_x", "place in the file, from 0, of the ray with the largest |ulp_error|");
        table.set_meaning("worst_y", "0");
        return table;
    }
};

MapFiles::MapFiles(const EvaluationRequest& request, const MapFilesOptions& options)
    : parts_(new Parts{.request = request, .options = options}) {
    Parts& p = *parts_;
    // In front of an hour of drawing titles.
    const std::size_t of_row = (options.singles ? options.drawn.size() : 0) + (options.pixels_csv ? 1 : 0);
    file::require_open_files(request.rows.size() * of_row + options.drawn.size() + 2, options.folder.string(),
                             "select fewer forms, formats or metrics");
    const bool tabled = !options.keep && options.sheet_alone.empty();
    if (tabled)
        p.summary.emplace(options.folder, "summary.csv",
                          options.by.empty() ? "One row per form and format" : "One row per form, format and group",
                          p.summary_columns());
    if (tabled && asks_for_culprits(request.metrics))
        p.culprits.emplace(options.folder, "culprits.csv", "One row per form, format and operation that is a culprit",
                           culprit_table());
    p.sheets = sheets_of(request, options);
    for (const TestedForm& row : request.rows) {
        request.limit.stop.check();
        p.rows.push_back(std::make_unique<RowFiles>(request, row, p.options, image::image_backend(), p.sheets));
    }
}

MapFiles::~MapFiles() = default;

std::vector<EvaluationSink*> MapFiles::sinks() {
    std::vector<EvaluationSink*> sinks;
    for (const auto& row : parts_->rows) sinks.push_back(row.get());
    return sinks;
}

void MapFiles::put(std::size_t row, MapPiece&& piece) { parts_->rows.at(row)->put(piece); }

void MapFiles::finish(const std::vector<FormSummary>& summaries, const measure::evaluate::Groups& groups) {
    Parts& p = *parts_;
    std::uint64_t inside = 0;
    // Side by side: a row's legend and the last of its picture are its own, and so is its place on a sheet.
    intersect::process::in_parallel(std::size_t{0}, p.rows.size(),
                                    [&](std::size_t r) { p.rows[r]->finish(summaries[r]); });
    for (const auto& row : p.rows) inside += row->inside();
    for (MapSheet& sheet : p.sheets) sheet.finish(p.request, summaries, p.options, inside);
    if (!p.summary) return;
    const auto name_of = [&p](const measure::evaluate::WorstRay& ray) {
        return p.options.name_of_ray ? p.options.name_of_ray(ray)
                                     : blame::name_of_pixel(p.options.named, static_cast<int>(ray.x), ray.y);
    };
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        p.summary->add_all(summary_rows(r, p.request.rows[r], summaries[r], groups, name_of));
        if (p.culprits) p.culprits->add_all(culprits_of(p.request.metrics, p.request.rows[r], summaries[r]));
    }

    std::vector<file::DataResource> resources{p.summary->about()};
    if (p.culprits) resources.push_back(p.culprits->about());
    for (const auto& row : p.rows)
        if (row->table()) resources.push_back(row->table()->about());
    resources.insert(resources.end(), p.options.also.begin(), p.options.also.end());
    file::write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    if (p.options.exr) p.options.exr->close();
    if (p.culprits) p.culprits->close();
    p.summary->close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::map
