#include "output/picture/render_files.hpp"

#include "output/map/row_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::picture {

using measure::evaluate::TestedForm;
using measure::picture::RenderBand;
using measure::picture::RenderRequest;

namespace {

table::Table<StageRow> stage_table() {
    using R = StageRow;
    table::Table<R> table{{"stage", "string", "", "last stage of the picture: visible, diffuse, shadows or phong",
                           [](const R& r) { return name_of(r.stage); }}};
    table.add(table::subject_columns("form that finds hits and shadows", "format of all computations"), &R::row);
    for (const auto& column : measure::picture::render_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    return table;
}

pixel::ExrLayers<RenderBand> layers_of(const measure::picture::RenderRequest& request) {
    pixel::ExrLayers<RenderBand> layers;
    layers.add_preview(
        [](const RenderBand& band, std::size_t i) { return picture_look().colour(pixel_of(band.painted.back()[i])); });
    for (std::size_t s = 0; s < request.stages.size(); ++s) {
        const std::string name(name_of(request.stages[s]));
        const auto stage = static_cast<std::size_t>(request.stages[s]);
        for (int k = 0; k < 3; ++k)
            layers.add_number(name + "." + "rgb"[k],
                              [s, k](const RenderBand& band, std::size_t i) { return band.painted[s][i].colour[k]; });
        for (std::size_t k = 0; k < 3; ++k)
            layers.add_number(name + "_true." + "rgb"[k], [stage, k](const RenderBand& band, std::size_t i) {
                const measure::picture::TrueColour& truth = band.truth[i].colours[stage];
                return truth.certain ? truth.channel[k].hi : measure::truth::missing;
            });
        layers.add_number(name + ".difference",
                          [s](const RenderBand& band, std::size_t i) { return band.painted[s][i].error; });
    }
    layers.add_number("normal.angle", [](const RenderBand& band, std::size_t i) { return band.normal_angle[i]; });
    layers.add_number("point.residual", [](const RenderBand& band, std::size_t i) { return band.residual[i]; });
    layers.add_count("class.seen", [](const RenderBand& band, std::size_t i) { return band.seen[i]; });
    layers.add_count("class.shadow", [](const RenderBand& band, std::size_t i) {
        return band.shadow.empty() ? measure::picture::Shadow{} : band.shadow[i];
    });
    layers.add_count("class.object", [](const RenderBand& band, std::size_t i) {
        return band.answers->hit[i] != 0 ? band.answers->object[i] + 1 : 0;
    });
    layers.add_count("class.true_object",
                     [](const RenderBand& band, std::size_t i) { return band.truth_object[i] + 1; });
    return layers;
}

}  // namespace

RenderExr::RenderExr(const std::filesystem::path& path, const measure::picture::RenderRequest& request,
                     const measure::evaluate::TestedForm& row, const std::string& command)
    : layers_(layers_of(request)) {
    const image::ExrSpec spec{.width = request.scene.width,
                              .height = request.scene.height,
                              .channels = layers_.channels(),
                              .attributes = {{"lostbits:command", command},
                                             {"lostbits:schema", "lostbits-render/1"},
                                             {"lostbits:scene", request.scene.id},
                                             {"lostbits:form", std::string(row.form->info->name)},
                                             {"lostbits:format", row.format.name},
                                             image::compiler_attribute(),
                                             {"lostbits:seen", pixel::numbered(measure::picture::seen_names)},
                                             {"lostbits:shadow", pixel::numbered(measure::picture::shadow_names)},
                                             image::objects_attribute()}};
    book_ = std::make_unique<image::ExrBook>(path, std::vector{image::ExrPart{"", spec}});
}

RenderFiles::RenderFiles(const RenderRequest& request, pixel::SceneFilesOptions options)
    : request_(request),
      options_(std::move(options)),
      table_(options_.folder, "summary.csv", "One row per stage, form and format", stage_table()),
      grid_(request.rows),
      pictures_(render_pictures(request, grid_, options_)) {
    if (options_.folder.empty()) return;
    for (const TestedForm& row : request.rows)
        layers_.emplace_back(options_.folder / (map::row_name(row) + ".exr"), request, row, options_.command);
}

void RenderFiles::finish(const std::vector<measure::picture::RenderSummary>& summaries) {
    for (RenderExr& exr : layers_) exr.close();
    const std::size_t stages = request_.stages.size();
    for (std::size_t k = 0; k < summaries.size(); ++k) {
        const map::RowGrid::Place at = grid_.places[k / stages];
        pictures_.writer().set_note({1 + at.form, k % stages * grid_.formats.size() + at.format}, glance(summaries[k]));
    }
    pictures_.writer().finish();
    if (options_.folder.empty()) return;
    for (std::size_t s = 0; s < stages; ++s)
        for (std::size_t r = 0; r < request_.rows.size(); ++r)
            table_.add({request_.stages[s], &request_.rows[r], &summaries[r * stages + s]});
    // Closed last, because a summary marks a folder as complete.
    table::close_tables(options_.folder, request_.scene.title, table_);
}

}  // namespace lostbits::output::picture
