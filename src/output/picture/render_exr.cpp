#include "output/picture/render_exr.hpp"

#include "output/picture/render_pictures.hpp"

namespace lostbits::output::picture {

using measure::picture::RenderBand;

namespace {

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
    writer_ = image::image_backend().open_exr(
        path, {.width = request.scene->width,
               .height = request.scene->height,
               .channels = layers_.channels(),
               .attributes = {{"lostbits:command", command},
                              {"lostbits:schema", "lostbits-render/1"},
                              {"lostbits:scene", request.scene->id},
                              {"lostbits:form", std::string(row.form->info->name)},
                              {"lostbits:format", row.format.name},
                              image::compiler_attribute(),
                              {"lostbits:seen", pixel::numbered(measure::picture::seen_names)},
                              {"lostbits:shadow", pixel::numbered(measure::picture::shadow_names)},
                              image::objects_attribute()}});
}

}  // namespace lostbits::output::picture
