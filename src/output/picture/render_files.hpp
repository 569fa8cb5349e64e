// The files of a rendered scene: pictures, the certified picture, difference maps, EXR, contact sheet, summary.csv.
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

/// A pixel of a picture: NaN, and a colour that is not proved, are no colour of the picture.
[[nodiscard]] pixel::PixelValue pixel_of(const measure::picture::Painted& painted);
[[nodiscard]] const pixel::Look& picture_look();
/// Of maps of differences, in the order of `Seen`: what both see alike is a number, and black where it is not.
[[nodiscard]] std::vector<pixel::Category> seen_categories();
/// In the order of `Shadow`, and one more: what is not seen alike shares black with NaN.
[[nodiscard]] std::vector<pixel::Category> shadow_categories();

/// On the sheet forms across, the certified picture first; stages and formats down. Alone, `<stage>.reference.png` and
/// `<stage>.<form>.<format>.png` are the bare pictures, a pixel a pixel; `….colour.png` is the difference of the two,
/// and `<form>.<format>.residual.png`, `.normal.png`, `.shadow.png` are the differences that all stages share, the last
/// two where a stage needs them. `request` must outlive the columns.
[[nodiscard]] pixel::ColumnFiles<measure::picture::RenderBand> render_pictures(
    const measure::picture::RenderRequest& request, const map::RowGrid& grid, const pixel::SceneFilesOptions& options);
/// The note under a thumbnail: what a glance should take away.
[[nodiscard]] std::string glance(const measure::picture::RenderSummary& s);

struct StageRow {
    scene::file::Stage stage;
    const measure::evaluate::TestedForm* row;
    const measure::picture::RenderSummary* summary;
};

/// The EXR of one form in one format: every number that its pictures and difference maps were made of.
///
/// Channels, all 32 bits: `R`, `G`, `B` (the last stage's picture in linear light); for each stage `<stage>.r`, `.g`,
/// `.b` (FLOAT, display numbers as the format computed them, not clamped), `<stage>_true.r`, `.g`, `.b` (the certified
/// ones) and
/// `<stage>.difference` (8-bit steps); `normal.angle`, `point.residual`; `class.seen`, `class.shadow` (UINT, in the
/// order of the attributes `lostbits:seen` and `lostbits:shadow`), `class.object`, `class.true_object` (0 is
/// none, otherwise 1 + the sphere's number, counted from 0).
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

/// Opens every file at once, before any work, and gives all their final names in `finish`; see `MapFiles`.
/// The pictures are `render_pictures`; `<form>.<format>.exr` has what they were made of.
class RenderFiles {
public:
    /// `request` must outlive it.
    RenderFiles(const measure::picture::RenderRequest& request, pixel::SceneFilesOptions options);

    /// The certified picture, which all rows have, is taken with the first.
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
    std::vector<RenderExr> layers_;  ///< of each row; none beside a sheet alone
};

}  // namespace lostbits::output::picture
