#include "output/render/render_files.hpp"

#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::render {

using measure::render::RenderBand;

namespace {

using measure::render::Receiver;
using measure::render::SeenContent;
using measure::render::Shadow;
using S = RenderSummary;

/// Returns the number of points of a receiver that truly get the light. `count_truly_shadowed` counts those whose light
/// is truly blocked.
std::uint64_t count_truly_lit(const S& r, Receiver receiver) {
    return r.count(receiver, Shadow::both_lit) + r.count(receiver, Shadow::false_shadow) +
           r.count(receiver, Shadow::own_shadow);
}
std::uint64_t count_truly_shadowed(const S& r, Receiver receiver) {
    return r.count(receiver, Shadow::both_shadowed) + r.count(receiver, Shadow::false_light);
}

/// A part as a fraction of the whole; missing for a picture without shadows.
std::optional<double> shadow_fraction(const S& r, std::uint64_t part, std::uint64_t whole) {
    return r.rule.has_shadows ? table::fraction_or_missing(part, whole) : std::nullopt;
}

/// Columns of the numbers of a stage.
table::Table<S> number_columns() {
    using table::percentile;
    const auto seen = [](SeenContent content) { return [content](const S& r) { return r.count(content); }; };
    const auto shadows = [](Receiver receiver, Shadow shadow) {
        return [=](const S& r) { return table::when(r.rule.has_shadows, r.count(receiver, shadow)); };
    };
    const auto truly_lit = [](Receiver receiver) {
        return [=](const S& r) { return table::when(r.rule.has_shadows, count_truly_lit(r, receiver)); };
    };
    const auto truly_shadowed = [](Receiver receiver) {
        return [=](const S& r) { return table::when(r.rule.has_shadows, count_truly_shadowed(r, receiver)); };
    };
    return {
        // Contents
        {"pixels", "pixels of the picture", &S::pixels},
        {"same_sphere", "pixels on which form and truth see the same sphere", seen(SeenContent::same_sphere)},
        {"background", "pixels on which both see the background", seen(SeenContent::background)},
        {"other_sphere", "pixels on which the form sees another sphere than the true one",
         seen(SeenContent::other_sphere)},
        {"lost_sphere", "pixels on which the form sees the background instead of a sphere",
         seen(SeenContent::lost_sphere)},
        {"extra_sphere", "pixels on which the form sees a sphere where there is only background",
         seen(SeenContent::extra_sphere)},
        {"not_a_number", "pixels on which the form reports a hit at NaN", seen(SeenContent::not_a_number)},

        // Pixels in doubt, and changed pixels
        {"unresolved", "pixels whose content, shadow or colour could not be proved", &S::unresolved_count},
        {"changed", "pixels with a byte that differs from the certified picture", &S::changed_pixel_count},
        {"changed_fraction", "1", "changed, as a share of all pixels",
         [](const S& r) { return table::fraction_or_missing(r.changed_pixel_count, r.pixels); }},

        // Errors of colours, normals and points
        {"colour_error_mean", "8-bit steps",
         "mean of the largest |channel - true channel| * 255, where form and truth see the same",
         [](const S& r) { return file::number_or_missing(r.colour_error.mean()); }},
        {"colour_error_p50", "8-bit steps", "median (to 2^-11 of itself) of the same",
         percentile(&S::colour_error, 50)},
        {"colour_error_p99", "8-bit steps", "99th percentile of the same", percentile(&S::colour_error, 99)},
        {"colour_error_max", "8-bit steps", "largest of the same", percentile(&S::colour_error, 100)},
        {"colour_not_a_number", "pixels with a channel at NaN", &S::nan_colour_count},
        {"normal_angle_p50", "rad", "median angle between computed and true normal, on the same sphere",
         percentile(&S::normal_angle, 50)},
        {"normal_angle_p99", "rad", "99th percentile of the same", percentile(&S::normal_angle, 99)},
        {"normal_angle_max", "rad", "largest of the same", percentile(&S::normal_angle, 100)},
        {"residual_p50", "radius", "median of ||P - G| - r|/r, P the computed point, on the same sphere",
         percentile(&S::residual, 50)},
        {"residual_p99", "radius", "99th percentile of the same", percentile(&S::residual, 99)},
        {"residual_max", "radius", "largest of the same", percentile(&S::residual, 100)},

        // Light and shadow on spheres
        {"faces_away", "same_sphere, on the side away from the light",
         [](const S& r) { return table::when(r.rule.has_diffuse, r.facing_away_count); }},
        {"surface_lit", "same_sphere that faces the light and truly gets it", truly_lit(Receiver::sphere)},
        {"surface_shadowed", "same_sphere that faces the light, truly blocked by another sphere",
         truly_shadowed(Receiver::sphere)},
        {"false_shadow", "surface_lit that the form puts in the shadow of another sphere",
         shadows(Receiver::sphere, Shadow::false_shadow)},
        {"own_shadow", "surface_lit that the form puts in the shadow of its own sphere alone: acne",
         shadows(Receiver::sphere, Shadow::own_shadow)},
        {"false_light", "surface_shadowed that the form lights", shadows(Receiver::sphere, Shadow::false_light)},
        {"own_shadow_fraction", "1", "own_shadow, as a share of surface_lit",
         [](const S& r) {
             return shadow_fraction(r, r.count(Receiver::sphere, Shadow::own_shadow),
                                    count_truly_lit(r, Receiver::sphere));
         }},
        {"flip_fraction", "1", "false_shadow and false_light, as a share of surface_lit and surface_shadowed",
         [](const S& r) {
             return shadow_fraction(
                 r, r.count(Receiver::sphere, Shadow::false_shadow) + r.count(Receiver::sphere, Shadow::false_light),
                 count_truly_lit(r, Receiver::sphere) + count_truly_shadowed(r, Receiver::sphere));
         }},

        // Light and shadow on the background
        {"background_lit", "background that truly gets the light, as seen by both", truly_lit(Receiver::background)},
        {"background_shadowed", "background truly in shadow, as seen by both", truly_shadowed(Receiver::background)},
        {"background_false_shadow", "background_lit that the form puts in shadow",
         shadows(Receiver::background, Shadow::false_shadow)},
        {"background_false_light", "background_shadowed that the form lights",
         shadows(Receiver::background, Shadow::false_light)},

        // Appearance of the scene itself
        {"light_in_shadow_fraction", "1",
         "share of the certified picture's points that face the light, are in shadow, and get diffuse light anyway",
         [](const S& r) { return shadow_fraction(r, r.lit_in_true_shadow_count, r.truly_shadowed_point_count); }}};
}

}  // namespace

table::Table<StageRow> RenderPresentation::make_summary_table() {
    using R = StageRow;
    table::Table<R> table{{"stage", "last stage of the picture: visible, diffuse, shadows or phong",
                           [](const R& r) { return name_of(r.stage); }}};
    table.add(table::make_subject_columns("form that finds hits and shadows", "format of all computations"),
              &R::tested_form);
    table.add(number_columns(), &R::summary);
    return table;
}

std::vector<StageRow> RenderPresentation::make_summary_rows(const RenderStudy& study,
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
        return band.answers.hit[i] != 0 ? band.answers.primitive[i] + 1 : 0;
    });
    layers.add_uint("class.true_object",
                    [](const RenderBand& band, std::size_t i) { return band.true_primitive[i] + 1; });
    return layers;
}

image::ExrSpec RenderPresentation::make_exr_spec(const RenderStudy& study, std::size_t form_index,
                                                 const std::vector<image::Channel>& channels,
                                                 const std::string& command) {
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
