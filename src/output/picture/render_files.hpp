// Files of a rendered scene: pictures, the certified picture, difference maps, EXR, contact sheet, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/image/exr_book.hpp"
#include "output/map/row_names.hpp"
#include "output/pixel/columns.hpp"
#include "output/pixel/exr_layers.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::picture {

/// A pixel of a picture. NaN and a colour that is not proved have colours that no picture has.
[[nodiscard]] pixel::PixelValue pixel_of(const measure::picture::Painted& painted);
[[nodiscard]] const pixel::Look& picture_look();
/// Categories of difference maps, in the order of `Seen`. Where both see the same, the map shows a number, or black if
/// it is not one.
[[nodiscard]] std::vector<pixel::Category> seen_categories();
/// Categories in the order of `Shadow`, and one more: a pixel on which both see different things is black like NaN.
[[nodiscard]] std::vector<pixel::Category> shadow_categories();

/// The sheet has forms across, the certified picture first; stages and formats down. The single pictures
/// `<stage>.reference.png` and `<stage>.<form>.<format>.png` are bare, one pixel per pixel. `….colour.png` is the
/// difference of the two. `<form>.<format>.residual.png`, `.normal.png` and `.shadow.png` are differences that all
/// stages share; the last two exist if a stage needs them. `request` must outlive the columns.
[[nodiscard]] pixel::ColumnFiles<measure::picture::RenderBand> render_pictures(
    const measure::picture::RenderRequest& request, const map::RowGrid& grid, const pixel::SceneFilesOptions& options);
/// The note under a thumbnail, for a first glance.
[[nodiscard]] std::string glance(const measure::picture::RenderSummary& s);

struct StageRow {
    scene::file::Stage stage;
    const measure::evaluate::TestedForm* row;
    const measure::picture::RenderSummary* summary;
};

/// The EXR of one form in one format: every number that its pictures and difference maps were made of.
/// All channels have 32 bits. `R`, `G`, `B` are the last stage's picture in linear light. For each stage there are
/// `<stage>.r`, `.g`, `.b` (FLOAT, display numbers as the format computed them, not clamped), `<stage>_true.r`, `.g`,
/// `.b` (the certified ones) and `<stage>.difference` (8-bit steps). Then `normal.angle` and `point.residual`;
/// `class.seen` and `class.shadow` (UINT, in the order of the attributes `lostbits:seen` and `lostbits:shadow`);
/// `class.object` and `class.true_object` (0 is none, otherwise 1 + the index of the sphere, counted from 0).
class RenderExr {
public:
    RenderExr(const std::filesystem::path& path, const measure::picture::RenderRequest& request,
              const measure::evaluate::TestedForm& row, const std::string& command);

    void write(const measure::picture::RenderBand& band) {
        const auto samples = layers_.samples(band, band.seen.size());
        book_->write_rows(0, band.y0, band.rows, std::as_bytes(std::span(samples)));
    }
    void close() { book_->close(); }

private:
    pixel::ExrLayers<measure::picture::RenderBand> layers_;
    std::unique_ptr<image::ExrBook> book_;
};

/// Opens every file at once, before any work, and gives all their final names in `finish`; see `MapFiles`. The pictures
/// are those of `render_pictures`. `<form>.<format>.exr` has the numbers they were made of.
class RenderFiles {
public:
    /// `request` must outlive the object.
    RenderFiles(const measure::picture::RenderRequest& request, pixel::SceneFilesOptions options);

    /// Takes a band. The certified picture, which all rows share, is taken with the first row.
    void band(std::size_t row, const measure::picture::RenderBand& band) {
        if (row == 0) pictures_.take(request_.rows.size(), band, band.y0, band.truth.size());
        pictures_.take(row, band, band.y0, band.seen.size());
        if (!layers_.empty()) layers_[row].write(band);
    }
    void finish(const std::vector<measure::picture::RenderSummary>& summaries);

private:
    const measure::picture::RenderRequest& request_;
    pixel::SceneFilesOptions options_;
    table::TableFile<StageRow> table_;
    map::RowGrid grid_;
    pixel::ColumnFiles<measure::picture::RenderBand> pictures_;
    std::vector<RenderExr> layers_;  ///< one per row; none for a sheet alone
};

}  // namespace lostbits::output::picture
