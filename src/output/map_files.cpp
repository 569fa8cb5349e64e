#include "output/map_files.hpp"

#include <fmt/format.h>

#include "output/contact_sheet.hpp"
#include "output/datapackage.hpp"
#include "output/heatmap.hpp"
#include "output/map_colour.hpp"
#include "output/map_exr.hpp"
#include "output/map_tables.hpp"

namespace lostbits::output {
namespace {

std::size_t index_of(const std::vector<const Metric*>& all, const Metric* one) {
    return static_cast<std::size_t>(std::ranges::find(all, one) - all.begin());
}

std::string short_name(const Info& info) { return std::string(info.name.substr(info.name.find('.') + 1)); }

std::string clamp_note(const Metric& metric, const ColourScale& scale) {
    if (metric.ramp == Ramp::magnitude) return fmt::format("colour: |{}|, clamped at both ends of the bar", metric.name);
    return fmt::format("colour: {} from 0 to {:g}; more is drawn as {:g}", metric.name, scale.hi(), scale.hi());
}

/// The note under a thumbnail: what a glance should take away.
std::string glance(const MapSummary& s, std::size_t lost) {
    const auto percent = [](std::uint64_t part, std::uint64_t whole) {
        const double share = 100.0 * static_cast<double>(part) / static_cast<double>(whole);
        if (share < 0.1) return std::string("<0.1%");
        if (share > 99 && share < 100) return std::string(">99%");
        return fmt::format(fmt::runtime(share < 10 ? "{:.1f}%" : "{:.0f}%"), share);
    };
    std::string text = s.count(Outcome::agree_hit) == 0 ? "no hit agreed on" : fmt::format("p99 {:.1f} bits lost", s.metrics[lost].quantile(0.99));
    const std::uint64_t true_misses = s.rays - s.true_hits - s.count(Outcome::unresolved);
    std::vector<std::string> faults;
    if (const auto n = s.count(Outcome::false_miss)) faults.push_back(percent(n, s.true_hits) + " false miss");
    if (const auto n = s.count(Outcome::false_hit)) faults.push_back(percent(n, true_misses) + " false hit");
    if (const auto n = s.count(Outcome::not_a_number)) faults.push_back(percent(n, s.rays) + " NaN");
    if (s.count(Outcome::agree_hit) == 0 && faults.empty()) return "nothing hit";
    return fmt::format("{}{}{}", text, faults.empty() ? "" : "\n", fmt::join(faults, "\n"));
}

bool is_enveloped(const MapFilesOptions& options, const Metric& drawn) { return options.envelope && &drawn == find_metric("lost_bits"); }

LegendEntry envelope_entry(const ColourScale& scale, std::string count) {
    return {"paler: inside the envelope", paler(scale.map(scale.hi() / 2)), std::move(count)};
}

/// Every class that may occur, with the widest count, in a picture of so many pixels.
std::vector<LegendEntry> possible_legend(const MapFilesOptions& options, const Metric& drawn, const ColourScale& scale, std::uint64_t pixels) {
    auto entries = widest_legend(pixels);
    if (is_enveloped(options, drawn)) entries.push_back(envelope_entry(scale, fmt::format("{} (>99.9%)", pixels)));
    return entries;
}

/// Those that occurred; `inside` of the pixels are drawn paler.
std::vector<LegendEntry> final_legend(const MapSummary& summary, const ColourScale& scale, std::uint64_t inside) {
    auto entries = outcome_legend(summary);
    if (inside > 0) entries.push_back(envelope_entry(scale, count_text(inside, summary.rays)));
    return entries;
}

}  // namespace

/// The files of one row.
class RowFiles final : public MapSink {
public:
    struct Drawing {
        std::size_t metric;
        ColourScale scale;
        bool enveloped;
        std::unique_ptr<HeatmapWriter> heatmap;
    };

    RowFiles(const MapRequest& request, const MapRow& row, const MapFilesOptions& options, ImageBackend& backend, ContactSheet& sheet,
             std::size_t form, std::size_t format)
        : request_(request), row_(row), sheet_(sheet), form_(form), format_(format), lost_(index_of(request.metrics, find_metric("lost_bits"))),
          excess_(index_of(request.metrics, find_metric("excess_bits"))) {
        const std::string stem = std::string(row.form->info->name) + "." + row.format.name;
        exr_ = std::make_unique<MapExr>(backend, options.folder / (stem + ".exr"), request, row, options.command);
        for (const Metric* m : options.drawn) {
            const std::string suffix = options.drawn.size() == 1 ? "" : "." + std::string(m->name);
            drawings_.push_back({index_of(request.metrics, m), metric_scale(*m, request.rows, backend), is_enveloped(options, *m), nullptr});
            const auto pixels = static_cast<std::uint64_t>(request.scene->width) * static_cast<std::uint64_t>(request.scene->height);
            HeatmapSpec spec{.title = fmt::format("{} in {}: {}", row.form->info->name, row.format.name, m->name),
                             .subtitle = {request.scene->title, std::string(row.form->info->title), clamp_note(*m, drawings_.back().scale)},
                             .width = request.scene->width,
                             .height = request.scene->height,
                             .scale = drawings_.back().scale,
                             .unit = std::string(m->unit),
                             .legend = possible_legend(options, *m, drawings_.back().scale, pixels)};
            drawings_.back().heatmap = std::make_unique<HeatmapWriter>(backend, options.folder / (stem + suffix + ".png"), std::move(spec));
        }
        if (options.pixels_csv) csv_ = std::make_unique<CsvWriter>(options.folder / (stem + ".csv"), pixel_columns(request));
    }

    void band(const BandResult& result) override {
        for (Drawing& d : drawings_) {
            field_.resize(result.outcomes.size());
            for (std::size_t i = 0; i < field_.size(); ++i) field_[i] = pixel_colour(d.scale, result.outcomes[i], result.metrics[d.metric][i]);
            if (d.enveloped) draw_envelope(result);
            d.heatmap->write_rows(field_);
            if (&d != drawings_.data()) continue;
            sheet_.add_rows(form_, format_, result.y0, field_);
            exr_->write(result, field_);
        }
        if (csv_) write_pixels(*csv_, request_, row_, result);
    }

    void finish(const MapSummary& summary, std::size_t lost) {
        exr_->close();
        for (Drawing& d : drawings_) d.heatmap->finish(final_legend(summary, d.scale, d.enveloped ? inside_ : 0));
        if (csv_) csv_->close();
        sheet_.set_note(form_, format_, glance(summary, lost));
    }

    /// Pixels drawn paler, in any of the pictures of lost bits.
    [[nodiscard]] std::uint64_t inside() const { return inside_; }

private:
    /// NaN, where a metric does not exist, is inside nothing.
    void draw_envelope(const BandResult& result) {
        for (std::size_t i = 0; i < field_.size(); ++i) {
            if (!inside_envelope(result.metrics[lost_][i], result.metrics[excess_][i])) continue;
            field_[i] = paler(field_[i]);
            ++inside_;
        }
    }

    const MapRequest& request_;
    const MapRow& row_;
    ContactSheet& sheet_;
    std::size_t form_, format_;
    std::size_t lost_, excess_;  ///< metrics of the request; `excess_` is none without an envelope
    std::uint64_t inside_ = 0;
    std::unique_ptr<MapExr> exr_;
    std::vector<Drawing> drawings_;
    std::unique_ptr<CsvWriter> csv_;
    std::vector<Rgb8> field_;
};

struct MapFiles::Parts {
    const MapRequest& request;
    MapFilesOptions options;
    ColourScale scale;  ///< of the contact sheet
    std::unique_ptr<ContactSheet> sheet;
    std::vector<std::unique_ptr<RowFiles>> rows;
    std::unique_ptr<CsvWriter> summary;

    static std::vector<std::string> distinct(const std::vector<MapRow>& rows, const auto& name) {
        std::vector<std::string> names;
        for (const MapRow& row : rows) {
            if (std::ranges::find(names, name(row)) == names.end()) names.push_back(name(row));
        }
        return names;
    }
};

MapFiles::MapFiles(const MapRequest& request, const MapFilesOptions& options)
    : parts_(new Parts{request, options, metric_scale(*options.drawn.front(), request.rows, image_backend()), {}, {}, {}}) {
    ImageBackend& backend = image_backend();
    Parts& p = *parts_;
    const auto form_name = [](const MapRow& row) { return short_name(*row.form->info); };
    const auto format_name = [](const MapRow& row) { return row.format.name; };
    const auto forms = Parts::distinct(request.rows, form_name), formats = Parts::distinct(request.rows, format_name);
    const Metric& first = *options.drawn.front();
    const ColourScale& scale = p.scale;
    const auto pixels = static_cast<std::uint64_t>(request.scene->width) * static_cast<std::uint64_t>(request.scene->height);

    p.summary = std::make_unique<CsvWriter>(options.folder / "summary.csv", summary_columns(request.metrics, request.scene->shape()));
    p.sheet = std::make_unique<ContactSheet>(backend, options.folder / "contact.png",
                                             SheetSpec{.title = request.scene->title,
                                                       .subtitle = {fmt::format("{}, {} x {} rays", request.scene->id, request.scene->width, request.scene->height),
                                                                    clamp_note(first, scale)},
                                                       .forms = forms,
                                                       .formats = formats,
                                                       .field_width = request.scene->width,
                                                       .field_height = request.scene->height,
                                                       .scale = scale,
                                                       .unit = std::string(first.unit),
                                                       .legend = possible_legend(options, first, scale, pixels * request.rows.size())});
    for (const MapRow& row : request.rows) {
        const auto form = static_cast<std::size_t>(std::ranges::find(forms, form_name(row)) - forms.begin());
        const auto format = static_cast<std::size_t>(std::ranges::find(formats, format_name(row)) - formats.begin());
        p.rows.push_back(std::make_unique<RowFiles>(request, row, options, backend, *p.sheet, form, format));
    }
}

MapFiles::~MapFiles() = default;

std::vector<MapSink*> MapFiles::sinks() {
    std::vector<MapSink*> sinks;
    for (const auto& row : parts_->rows) sinks.push_back(row.get());
    return sinks;
}

void MapFiles::finish(const std::vector<MapSummary>& summaries) {
    Parts& p = *parts_;
    const std::size_t lost = index_of(p.request.metrics, find_metric("lost_bits"));
    MapSummary total;
    std::uint64_t inside = 0;
    for (std::size_t r = 0; r < p.rows.size(); ++r) {
        p.rows[r]->finish(summaries[r], lost);
        inside += p.rows[r]->inside();
        total.rays += summaries[r].rays;
        for (std::size_t o = 0; o < total.outcomes.size(); ++o) total.outcomes[o] += summaries[r].outcomes[o];
    }
    const Metric& first = *p.options.drawn.front();
    p.sheet->finish(final_legend(total, p.scale, is_enveloped(p.options, first) ? inside : 0));
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        add_summary(*p.summary, p.request.rows[r], summaries[r]);
        p.summary->end_row();
    }

    std::vector<DataResource> resources{{"summary.csv", "One row per form and format", summary_columns(p.request.metrics, p.request.scene->shape())}};
    if (p.options.pixels_csv) {
        for (const MapRow& row : p.request.rows) {
            const std::string stem = std::string(row.form->info->name) + "." + row.format.name;
            resources.push_back({stem + ".csv", fmt::format("One row per pixel: {} in {}", row.form->info->name, row.format.name), pixel_columns(p.request)});
        }
    }
    resources.insert(resources.end(), p.options.also.begin(), p.options.also.end());
    write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    p.summary->close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output
