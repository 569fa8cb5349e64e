#include "output/render/render_files.hpp"

#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::render {

using measure::render::RenderBand;

table::Table<StageRow> RenderPresentation::summary_table() {
    using R = StageRow;
    table::Table<R> table{{"stage", "last stage of the picture: visible, diffuse, shadows or phong",
                           [](const R& r) { return name_of(r.stage); }}};
    table.add(table::subject_columns("form that finds hits and shadows", "format of all computations"),
              &R::tested_form);
    for (const auto& column : measure::render::render_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    return table;
}

std::vector<StageRow> RenderPresentation::summary_rows(const RenderStudy& study,
                                                       const std::vector<RenderStudy::Summary>& summaries) {
    std::vector<StageRow> rows;
    for (std::size_t s = 0; s < study.stages.size(); ++s)
        for (std::size_t r = 0; r < study.tested_forms.size(); ++r)
            rows.push_back({study.stages[s], &study.tested_forms[r], &summaries[r][s]});
    return rows;
}

namespace {

/// Adds the picture of stage `s`, the certified picture, and their difference.
void add_stage(pixel::ExrLayers<RenderBand>& layers, const RenderStudy& study, std::size_t s) {
    const std::string name(name_of(study.stages[s]));
    const auto stage = static_cast<std::size_t>(study.stages[s]);
    for (int k = 0; k < 3; ++k)
        layers.add_number(name + "." + "rgb"[k],
                          [s, k](const RenderBand& band, std::size_t i) { return band.painted[s][i].colour[k]; });
    for (std::size_t k = 0; k < 3; ++k)
        layers.add_number(name + "_true." + "rgb"[k], [stage, k](const RenderBand& band, std::size_t i) {
            const measure::render::TrueColour& true_colour = band.true_pixels[i].colours[stage];
            return true_colour.is_certain ? true_colour.channel[k].hi : measure::truth::missing;
        });
    layers.add_number(name + ".difference",
                      [s](const RenderBand& band, std::size_t i) { return band.painted[s][i].error; });
}

}  // namespace

pixel::ExrLayers<RenderBand> RenderPresentation::layers(const RenderStudy& study) {
    pixel::ExrLayers<RenderBand> layers;
    layers.add_preview(
        [](const RenderBand& band, std::size_t i) { return picture_look().colour(pixel_of(band.painted.back()[i])); });
    for (std::size_t s = 0; s < study.stages.size(); ++s) add_stage(layers, study, s);

    // Errors and decisions that all stages share.
    layers.add_number("normal.angle", [](const RenderBand& band, std::size_t i) { return band.normal_angle[i]; });
    layers.add_number("point.residual", [](const RenderBand& band, std::size_t i) { return band.residual[i]; });
    layers.add_uint("class.seen", [](const RenderBand& band, std::size_t i) { return band.seen[i]; });
    layers.add_uint("class.shadow", [](const RenderBand& band, std::size_t i) {
        return band.shadow.empty() ? measure::render::Shadow{} : band.shadow[i];
    });
    layers.add_uint("class.object", [](const RenderBand& band, std::size_t i) {
        return band.answers.hit[i] != 0 ? band.answers.object[i] + 1 : 0;
    });
    layers.add_uint("class.true_object",
                    [](const RenderBand& band, std::size_t i) { return band.true_primitive[i] + 1; });
    return layers;
}

image::ExrSpec RenderPresentation::exr_spec(const RenderStudy& study, std::size_t form_index,
                                            const std::vector<image::Channel>& channels, const std::string& command) {
    return {.width = study.scene.width,
            .height = study.scene.height,
            .channels = channels,
            .attributes = {{"lostbits:command", command},
                           {"lostbits:schema", "lostbits-render/1"},
                           {"lostbits:scene", study.scene.id},
                           {"lostbits:form", std::string(study.tested_forms[form_index].form->info->name)},
                           {"lostbits:format", study.tested_forms[form_index].format.name},
                           image::compiler_attribute(),
                           {"lostbits:seen", pixel::numbered_list(measure::render::seen_names)},
                           {"lostbits:shadow", pixel::numbered_list(measure::render::shadow_names)},
                           image::primitives_attribute()}};
}

}  // namespace lostbits::output::render
