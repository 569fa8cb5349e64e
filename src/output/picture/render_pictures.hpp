// The pictures of a rendered scene on one page, each beside the certified one; and each alone, with its difference
// maps.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/map/row_names.hpp"
#include "output/pixel/columns.hpp"

namespace lostbits::output::picture {

/// A pixel of a picture: NaN, and a colour that is not proved, are no colour of the picture.
[[nodiscard]] pixel::PixelValue pixel_of(const measure::picture::Painted& painted);
[[nodiscard]] const pixel::Look& picture_look();
/// Of maps of differences, in the order of `Seen`: what both see alike is a number, and black where it is not.
[[nodiscard]] std::vector<pixel::Category> seen_categories();
/// In the order of `Shadow`, and one more: what is not seen alike shares black with NaN.
[[nodiscard]] std::vector<pixel::Category> shadow_categories();

/// Some lines of a row, or of the certified picture.
struct RenderStrip {
    const measure::picture::RenderBand* band;
    std::span<const measure::picture::TruePixel> truth;
};

/// On the sheet forms across, the certified picture first; stages and formats down. Alone, `<stage>.reference.png` and
/// `<stage>.<form>.<format>.png` are the bare pictures, a pixel a pixel; `….colour.png` is the difference of the two,
/// and `<form>.<format>.residual.png`, `.normal.png`, `.shadow.png` are the differences that all stages share, the last
/// two where a stage needs them. `request` must outlive the columns.
[[nodiscard]] pixel::ColumnFiles<RenderStrip> render_pictures(const measure::picture::RenderRequest& request,
                                                              const map::RowGrid& grid,
                                                              const pixel::SceneFilesOptions& options);
/// The note under a thumbnail: what a glance should take away.
[[nodiscard]] std::string glance(const measure::picture::RenderSummary& s);

}  // namespace lostbits::output::picture
