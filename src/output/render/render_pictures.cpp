// Draws rendered scenes and their difference maps.
#include "output/render/render_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/map/map_pictures.hpp"

namespace lostbits::output::render {

using image::Rgb8;
using measure::answer::Outcome;
using measure::render::RenderBand;
using measure::render::SeenContent;
using measure::render::ShadeRule;
using measure::render::Shadow;
using pixel::colour_of;
using pixel::DrawnColumn;
using pixel::fraction_text;
using pixel::Look;
using pixel::PixelValue;
using scene::file::Stage;

namespace {

using SharedLook = std::shared_ptr<const Look>;

constexpr Rgb8 nan_colour{255, 0, 255}, lit_colour{255, 255, 125};

/// Categories of a picture, in the order of `picture_look`.
namespace picture_category {
constexpr std::size_t not_a_number = 1, not_proved = 2;  // 0: the pixel has a colour
}

/// Texts and range of a map of the difference between the picture of a form and the certified picture. A pixel that
/// shows different things in the two pictures has the colour of its category instead of a number.
struct DifferenceMap {
    const char* title;
    const char* unit;
    const char* note;
    double low, high;  ///< ends of the colour bar
};
constexpr DifferenceMap colour_map{"difference of colour", "8-bit steps",
                                   "colour: largest |channel - true channel| x 255, clamped at both ends of the bar",
                                   0x1p-18, 0x1p8},
    normal_map{"angle of the normal", "radians",
               "colour: angle between the computed and the true normal, clamped at both ends of the bar", 0x1p-30, 1},
    residual_map{"hit point off the surface", "radii",
                 "colour: ||P - G| - r|/r of the computed point P, clamped at both ends of the bar", 0x1p-30, 1};

SharedLook difference_look(const DifferenceMap& map) {
    return std::make_shared<const Look>(Look{seen_categories(), pixel::magnitude_scale(map.low, map.high), map.unit});
}

/// Value of a pixel of a difference map. An unchanged background stays grey.
PixelValue difference_pixel(SeenContent seen, double value) {
    const bool has_number = seen == SeenContent::same_sphere || (seen == SeenContent::background && value > 0);
    return {static_cast<std::size_t>(seen), has_number ? value : measure::truth::missing};
}

PixelValue shadow_pixel(SeenContent seen, Shadow shadow) {
    if (seen == SeenContent::same_sphere || seen == SeenContent::background) return {static_cast<std::size_t>(shadow)};
    return {seen == SeenContent::unresolved ? static_cast<std::size_t>(Shadow::unresolved)
                                            : measure::render::shadow_names.size()};
}

PixelValue certified_pixel(const measure::render::TrueColour& c) {
    return c.is_certain ? PixelValue{.colour = Rgb8{c.byte[0], c.byte[1], c.byte[2]}}
                        : PixelValue{picture_category::not_proved};
}

constexpr const char* sheet_note =
    "wrong colour: a byte differs from the certified picture; wrong sphere: another sphere is seen, none where there "
    "is one, or one where there is none";

image::SheetSpec make_sheet_spec(const RenderStudy& study, const map::FormGrid& grid) {
    const scene::file::Scene& scene = study.scene;
    image::SheetSpec spec{.title = scene.title,
                          .subtitle = {fmt::format("{}, {} x {} pixels; percentages are of all pixels", scene.id,
                                                   scene.width, scene.height),
                                       "the picture of each form in each format, next to the certified one", sheet_note,
                                       map::input_note(scene, study.tested_forms)},
                          .column_labels = {"certified"}};
    std::erase(spec.subtitle, "");

    spec.column_labels.insert(spec.column_labels.end(), grid.forms.begin(), grid.forms.end());
    for (const Stage stage : study.stages)
        for (const std::string& format : grid.formats)
            spec.row_labels.push_back(fmt::format("{}, {}", name_of(stage), format));
    return spec;
}

/// Collects the pixel columns of a study.
class RenderColumnMaker {
public:
    explicit RenderColumnMaker(const RenderStudy& study) : study_(study), grid_(study.tested_forms) {
        for (std::size_t s = 0; s < study.stages.size(); ++s) add_reference(s);
        for (std::size_t r = 0; r < study.tested_forms.size(); ++r) add_row(r);
    }
    [[nodiscard]] std::vector<DrawnColumn<RenderBand>> release() { return std::move(columns_); }

private:
    /// The certified picture, which all rows share. It is drawn from the bands of the first row.
    void add_reference(std::size_t s) {
        pixel::ColumnSpec spec{.file = fmt::format("{}.reference.png", name_of(study_.stages[s])),
                               .look = picture_look_,
                               .has_only_pixels = true};
        for (std::size_t f = 0; f < grid_.formats.size(); ++f)
            spec.sheet_positions.push_back({0, s * grid_.formats.size() + f});
        add(std::move(spec), 0,
            [stage = static_cast<std::size_t>(study_.stages[s])](const RenderBand& band, std::size_t i) {
                return certified_pixel(band.true_pixels[i].colours[stage]);
            });
    }

    void add_row(std::size_t r) {
        const std::string name = map::tested_form_name(study_.tested_forms[r]);

        // For each stage: the picture, and how far its colours differ from the certified ones.
        for (std::size_t s = 0; s < study_.stages.size(); ++s) {
            const std::string stage(name_of(study_.stages[s]));
            const map::FormGrid::GridCell cell = grid_.cells[r];
            add({.file = fmt::format("{}.{}.png", stage, name),
                 .look = picture_look_,
                 .sheet_positions = {{1 + cell.form_index, s * grid_.formats.size() + cell.format_index}},
                 .has_only_pixels = true},
                r, [s](const RenderBand& band, std::size_t i) { return pixel_of(band.painted[s][i]); });
            add(difference_map_spec(r, fmt::format("{}.{}.colour.png", stage, name),
                                    fmt::format("{}, {}", stage, colour_map.title), colour_map.note, colour_look_),
                r, [s](const RenderBand& band, std::size_t i) {
                    return difference_pixel(band.seen[i], band.painted[s][i].error);
                });
        }

        // Maps that belong to all stages.
        add(difference_map_spec(r, name + ".residual.png", residual_map.title, residual_map.note, residual_look_), r,
            [](const RenderBand& band, std::size_t i) { return difference_pixel(band.seen[i], band.residual[i]); });
        if (any_stage_has(&ShadeRule::has_diffuse))
            add(difference_map_spec(r, name + ".normal.png", normal_map.title, normal_map.note, normal_look_), r,
                [](const RenderBand& band, std::size_t i) {
                    return difference_pixel(band.seen[i], band.normal_angle[i]);
                });
        if (any_stage_has(&ShadeRule::has_shadows))
            add(difference_map_spec(r, name + ".shadow.png", "shadow decisions",
                                    "shadow decisions where both see the same: on the lit sides of spheres, and on the "
                                    "background if it is a plane",
                                    shadow_look_),
                r, [](const RenderBand& band, std::size_t i) { return shadow_pixel(band.seen[i], band.shadow[i]); });
    }

    [[nodiscard]] pixel::ColumnSpec difference_map_spec(std::size_t r, std::string file, const std::string& title,
                                                        const char* note, SharedLook look) const {
        const measure::evaluate::TestedForm& tested_form = study_.tested_forms[r];
        return {.file = std::move(file),
                .title = fmt::format("{} in {}: {}", tested_form.form->info->name, tested_form.format.name, title),
                .subtitle = {map::title_of(*tested_form.form->info), note},
                .look = std::move(look)};
    }

    [[nodiscard]] bool any_stage_has(bool ShadeRule::*property) const {
        return std::ranges::any_of(study_.stages, [&](Stage s) {
            return measure::render::make_shade_rule(study_.scene.appearance, s).*property;
        });
    }

    template <class ValueOf>
    void add(pixel::ColumnSpec spec, std::size_t form_index, ValueOf value_of) {
        columns_.push_back({std::move(spec), form_index, pixel::make_draw_function<RenderBand>(value_of)});
    }

    const RenderStudy& study_;
    map::FormGrid grid_;
    SharedLook picture_look_ = std::make_shared<const Look>(picture_look()),
               shadow_look_ = std::make_shared<const Look>(Look{shadow_categories()}),
               colour_look_ = difference_look(colour_map), normal_look_ = difference_look(normal_map),
               residual_look_ = difference_look(residual_map);
    std::vector<DrawnColumn<RenderBand>> columns_;
};

}  // namespace

std::vector<pixel::Category> seen_categories() {
    return {{"", colour_of(Outcome::not_a_number)},
            {"background", colour_of(Outcome::agree_miss)},
            {"another sphere", colour_of(Outcome::wrong_primitive)},
            {"sphere lost", colour_of(Outcome::false_miss)},
            {"sphere where there is none", colour_of(Outcome::false_hit)},
            {"not a number", colour_of(Outcome::not_a_number)},
            {"not proved", colour_of(Outcome::unresolved)}};
}

std::vector<pixel::Category> shadow_categories() {
    return {{"not compared", colour_of(Outcome::agree_miss)},
            {"both lit", lit_colour},
            {"both in shadow", colour_of(Outcome::agree_hit)},
            {"false shadow", colour_of(Outcome::false_hit)},
            {"own shadow (acne)", colour_of(Outcome::wrong_primitive)},
            {"false light", colour_of(Outcome::false_miss)},
            {"not proved", colour_of(Outcome::unresolved)},
            {"sees something else, or NaN", colour_of(Outcome::not_a_number)}};
}

const Look& picture_look() {
    static const Look look{{{""}, {"not a number", nan_colour}, {"colour not proved", colour_of(Outcome::unresolved)}}};
    return look;
}

PixelValue pixel_of(const measure::render::PaintedPixel& p) {
    if (std::isnan(p.colour.x) || std::isnan(p.colour.y) || std::isnan(p.colour.z))
        return {picture_category::not_a_number};
    return {.colour = Rgb8{p.byte[0], p.byte[1], p.byte[2]}};
}

std::vector<DrawnColumn<RenderBand>> RenderPresentation::columns(const RenderStudy& study) {
    return RenderColumnMaker(study).release();
}

pixel::SheetFile RenderPresentation::sheet(const RenderStudy& study, const std::filesystem::path& file) {
    return {file, make_sheet_spec(study, map::FormGrid(study.tested_forms))};
}

std::vector<study::Note> RenderPresentation::notes(const RenderStudy& study,
                                                   const std::vector<RenderStudy::Summary>& summaries) {
    const map::FormGrid grid(study.tested_forms);
    std::vector<study::Note> notes;
    for (std::size_t r = 0; r < summaries.size(); ++r)
        for (std::size_t s = 0; s < summaries[r].size(); ++s)
            notes.push_back({{1 + grid.cells[r].form_index, s * grid.formats.size() + grid.cells[r].format_index},
                             thumbnail_note(summaries[r][s])});
    return notes;
}

std::string thumbnail_note(const RenderSummary& summary) {
    std::string text = summary.changed_pixel_count == 0
                           ? "every pixel right"
                           : fraction_text(summary.changed_pixel_count, summary.pixels) + " wrong colour";
    if (const std::uint64_t wrong = summary.wrong_pixel_count())
        text += fmt::format("\n{} wrong sphere", fraction_text(wrong, summary.pixels));
    if (!summary.rule.has_shadows) return text;
    const auto acne = summary.count(measure::render::Receiver::sphere, Shadow::own_shadow);
    if (acne > 0) text += fmt::format("\n{} acne", fraction_text(acne, summary.pixels));
    if (const auto flips = summary.flipped_shadow_count())
        text += fmt::format("{}{} shadow flips", acne > 0 ? ", " : "\n", flips);
    return text;
}

}  // namespace lostbits::output::render
