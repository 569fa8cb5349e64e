#include "output/picture/render_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/heatmap.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/row_names.hpp"
#include "output/picture/render_colour.hpp"
#include "output/picture/render_exr.hpp"
#include "output/picture/render_sheet.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::picture {

using image::HeatmapWriter;
using map::row_name;
using measure::evaluate::TestedForm;
using measure::picture::RenderBand;
using measure::picture::RenderRequest;
using measure::picture::ShadeRule;

namespace {

bool any_stage(const RenderRequest& request, bool ShadeRule::*asks) {
    return std::ranges::any_of(request.stages, [&](scene::file::Stage s) {
        return measure::picture::shade_rule(request.scene->appearance, s).*asks;
    });
}

image::HeatmapSpec map_spec(const RenderRequest& request, const TestedForm& row, const std::string& title,
                            const std::string& note, std::vector<image::LegendEntry> legend) {
    return {.title = fmt::format("{} in {}: {}", row.form->info->name, row.format.name, title),
            .subtitle = {request.scene->title, map::title_of(*row.form->info), note},
            .width = request.scene->width,
            .height = request.scene->height,
            .scale = std::nullopt,
            .unit = "",
            .legend = std::move(legend)};
}

/// A difference map of one row.
struct DifferenceMap {
    ErrorMap kind;
    std::size_t stage;  ///< of the request; the differences of normal and residual have none
    image::ColourScale scale;
    std::unique_ptr<HeatmapWriter> heatmap;
};

struct StageRow {
    scene::file::Stage stage;
    const TestedForm* row;
    const measure::picture::RenderSummary* summary;
};

table::Table<StageRow> stage_table() {
    using R = StageRow;
    table::Table<R> table{{"stage", "string", "", "how far the picture goes: visible, diffuse, shadows, phong",
                           [](const R& r) { return name_of(r.stage); }}};
    table.add(table::subject_columns("form that finds hits and shadows", "format that everything is computed in"),
              &R::row);
    for (const auto& column : measure::picture::render_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    return table;
}

}  // namespace

/// The files of one form in one format.
class RenderRowFiles {
public:
    RenderRowFiles(const RenderRequest& request, const TestedForm& row, const RenderFilesOptions& options,
                   image::ImageBackend& backend)
        : exr_(backend, options.folder / (row_name(row) + ".exr"), request, row, options.command) {
        const auto open = [&](ErrorMap d, std::size_t stage, const std::string& name, const std::string& title) {
            const ErrorMapKind& kind = error_map_kind(d);
            image::HeatmapSpec spec =
                map_spec(request, row, title, kind.note, widest_seen_legend(request.scene->pixels()));
            spec.scale = error_map_scale(d, backend);
            spec.unit = kind.unit;
            const image::ColourScale scale = *spec.scale;
            maps_.push_back(
                {d, stage, scale, std::make_unique<HeatmapWriter>(backend, options.folder / name, std::move(spec))});
        };
        for (std::size_t s = 0; s < request.stages.size(); ++s) {
            request.limit.stop.check();
            const std::string stage(name_of(request.stages[s]));
            pictures_.push_back(backend.open_png(options.folder / fmt::format("{}.{}.png", stage, row_name(row)),
                                                 request.scene->width, request.scene->height));
            open(ErrorMap::colour, s, fmt::format("{}.{}.colour.png", stage, row_name(row)),
                 fmt::format("{}, {}", stage, error_map_kind(ErrorMap::colour).title));
        }
        open(ErrorMap::residual, 0, row_name(row) + ".residual.png", error_map_kind(ErrorMap::residual).title);
        if (any_stage(request, &ShadeRule::diffuse))
            open(ErrorMap::normal, 0, row_name(row) + ".normal.png", error_map_kind(ErrorMap::normal).title);
        if (any_stage(request, &ShadeRule::shadows)) {
            const char* const note =
                "shadow decisions where both see the same: on spheres that face the light, and on the background if "
                "it is a plane";
            shadow_ = std::make_unique<HeatmapWriter>(
                backend, options.folder / (row_name(row) + ".shadow.png"),
                map_spec(request, row, "shadow decisions", note, widest_shadow_legend(request.scene->pixels())));
        }
    }

    void band(const RenderBand& band) {
        const std::size_t n = band.seen.size();
        field_.resize(n);
        for (std::size_t s = 0; s < pictures_.size(); ++s) {
            for (std::size_t i = 0; i < n; ++i) field_[i] = picture_colour(band.painted[s][i]);
            pictures_[s]->write_rows(band.rows, field_);
        }
        for (DifferenceMap& map : maps_) {
            for (std::size_t i = 0; i < n; ++i)
                field_[i] = error_map_colour(map.scale, band.seen[i], value(map, band, i));
            map.heatmap->write_rows(field_);
        }
        if (shadow_) {
            for (std::size_t i = 0; i < n; ++i) field_[i] = shadow_colour(band.seen[i], band.shadow[i]);
            shadow_->write_rows(field_);
        }
        exr_.write(band);
    }

    /// `summaries`: one a stage.
    void finish(std::span<const measure::picture::RenderSummary> summaries) {
        for (const auto& picture : pictures_) picture->close();
        for (DifferenceMap& map : maps_) map.heatmap->finish(seen_legend(summaries[map.stage]));
        if (shadow_) shadow_->finish(shadow_legend(summaries.back()));
        exr_.close();
    }

private:
    static double value(const DifferenceMap& map, const RenderBand& band, std::size_t i) {
        switch (map.kind) {
            case ErrorMap::colour: return band.painted[map.stage][i].error;
            case ErrorMap::normal: return band.normal_angle[i];
            case ErrorMap::residual: return band.residual[i];
        }
        return 0;
    }

    RenderExr exr_;
    std::vector<std::unique_ptr<image::PngWriter>> pictures_;
    std::vector<DifferenceMap> maps_;
    std::unique_ptr<HeatmapWriter> shadow_;
    std::vector<image::Rgb8> field_;
};

struct RenderFiles::Parts {
    const RenderRequest& request;
    RenderFilesOptions options;
    table::TableFile<StageRow> table;
    RenderSheet sheet;
    std::vector<std::unique_ptr<image::PngWriter>> references{};  ///< one a stage
    std::vector<std::unique_ptr<RenderRowFiles>> rows{};
};

RenderFiles::RenderFiles(const RenderRequest& request, const RenderFilesOptions& options)
    : parts_(new Parts{request, options,
                       table::TableFile<StageRow>(options.folder, "summary.csv", "One row per stage, form and format",
                                                  stage_table()),
                       RenderSheet(image::image_backend(), options.folder / "contact.png", request)}) {
    const scene::file::Scene& scene = *request.scene;
    for (const scene::file::Stage stage : request.stages) {
        parts_->references.push_back(image::image_backend().open_png(
            options.folder / fmt::format("{}.reference.png", name_of(stage)), scene.width, scene.height));
    }
    for (const TestedForm& row : request.rows)
        parts_->rows.push_back(std::make_unique<RenderRowFiles>(request, row, options, image::image_backend()));
}

RenderFiles::~RenderFiles() = default;

void RenderFiles::reference(int y0, int rows, std::span<const measure::picture::TruePixel> truth) {
    Parts& p = *parts_;
    std::vector<image::Rgb8> field(truth.size());
    for (std::size_t s = 0; s < p.references.size(); ++s) {
        const auto stage = static_cast<std::size_t>(p.request.stages[s]);
        std::ranges::transform(truth, field.begin(), [stage](const measure::picture::TruePixel& pixel) {
            return picture_colour(pixel.colours[stage]);
        });
        p.references[s]->write_rows(rows, field);
    }
    p.sheet.reference(y0, rows, truth);
}

void RenderFiles::row(std::size_t row, const RenderBand& band) {
    parts_->rows[row]->band(band);
    parts_->sheet.row(row, band);
}

void RenderFiles::finish(const std::vector<measure::picture::RenderSummary>& summaries) {
    Parts& p = *parts_;
    const std::size_t stages = p.request.stages.size();
    for (std::size_t r = 0; r < p.rows.size(); ++r) p.rows[r]->finish(std::span(summaries).subspan(r * stages, stages));
    for (const auto& picture : p.references) picture->close();
    p.sheet.finish(summaries);

    for (std::size_t s = 0; s < stages; ++s)
        for (std::size_t r = 0; r < p.rows.size(); ++r)
            p.table.add({p.request.stages[s], &p.request.rows[r], &summaries[r * stages + s]});
    // Closed last: a folder with a summary is a finished one.
    table::close_tables(p.options.folder, p.request.scene->title, p.table);
}

}  // namespace lostbits::output::picture
