// Files of a rendered scene: pictures, the certified picture, difference maps, EXR, contact sheet, summary.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/render/render.hpp"
#include "output/map/form_names.hpp"
#include "output/study/study_files.hpp"

namespace lostbits::output::render {

using measure::render::RenderStudy;
using measure::render::RenderSummary;

/// Value of a pixel of a picture: its colour, or a category of its own if the colour has a NaN.
[[nodiscard]] pixel::PixelValue pixel_of(const measure::render::PaintedPixel& painted);
/// Categories of a picture: a colour, not a number, and not proved.
[[nodiscard]] const pixel::Look& picture_look();
/// Categories of difference maps, in the order of `SeenContent`. Where both pictures show the same sphere, the map
/// shows their difference, or black if it is not a number. Where both show the background and it differs, the map shows
/// the difference too.
[[nodiscard]] std::vector<pixel::Category> seen_categories();
/// Categories in the order of `Shadow`, and one more, black: the two pictures show different things, or the form's t is
/// NaN.
[[nodiscard]] std::vector<pixel::Category> shadow_categories();

/// Text below a thumbnail of the sheet: how much of the picture is wrong.
[[nodiscard]] std::string thumbnail_note(const RenderSummary& summary);

/// A row of summary.csv: a form in a format, at one stage of the picture.
struct StageRow {
    scene::file::Stage stage;
    const measure::evaluate::TestedForm* tested_form;
    const RenderSummary* summary;
};

/// A presentation, see output/study/study_files.hpp. On the sheet, each column is a form, after a column for the
/// certified picture. Each row is a stage in a format. The single pictures `<stage>.reference.png` (certified) and
/// `<stage>.<form>.<format>.png` are bare: no texts, and one image pixel for each pixel of the scene.
/// `<stage>.<form>.<format>.colour.png` shows how far their colours differ. The difference maps
/// `<form>.<format>.residual.png`, `.normal.png` and `.shadow.png` belong to all stages; the last two exist only if a
/// stage needs them.
///
/// `<form>.<format>.exr` has every number that the pictures and difference maps of a row were made of. All channels
/// have 32 bits. `R`, `G`, `B` are the last stage's picture in linear light. For each stage there are `<stage>.r`,
/// `.g`, `.b` (FLOAT, display numbers as the format computed them, not clamped), `<stage>_true.r`, `.g`, `.b` (the
/// certified ones) and `<stage>.difference` (8-bit steps). Then `normal.angle` and `point.residual`; `class.seen` and
/// `class.shadow` (UINT, in the order of the attributes `lostbits:seen` and `lostbits:shadow`); `class.object` and
/// `class.true_object` (0 is none, otherwise 1 + the index of the sphere, counted from 0).
struct RenderPresentation {
    using Study = RenderStudy;
    using Band = Study::Band;
    using SummaryRow = StageRow;
    static constexpr const char* summary_title = "One row per stage, form and format";

    static table::Table<StageRow> make_summary_table();
    static std::vector<StageRow> make_summary_rows(const Study& study, const std::vector<Study::Summary>& summaries);
    static std::string file_stem(const Study& study, std::size_t form_index) {
        return map::tested_form_name(study.tested_forms[form_index]);
    }
    static std::size_t pixels(const Band& band) { return band.seen.size(); }
    static std::vector<pixel::DrawnColumn<Band>> columns(const Study& study);
    static pixel::SheetFile sheet(const Study& study, const std::filesystem::path& file);
    static std::vector<study::Note> notes(const Study& study, const std::vector<Study::Summary>& summaries);
    static pixel::ExrLayers<Band> layers(const Study& study);
    /// `command` is the command line that writes the files again.
    static image::ExrSpec make_exr_spec(const Study& study, std::size_t form_index,
                                        const std::vector<image::Channel>& channels, const std::string& command);
};

}  // namespace lostbits::output::render
