// Columns of pixels and their files: each column is a cell of one sheet and, where asked for, a picture of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "output/image/contact_sheet.hpp"
#include "output/image/heatmap.hpp"
#include "output/pixel/look.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::pixel {

/// A place on a sheet.
struct SheetPlace {
    std::size_t across = 0, down = 0;
};

/// What a column says once: its name, what its pixels are and what the picture of it says.
struct ColumnSpec {
    std::string file;  ///< of its own picture
    std::string title = {};
    std::vector<std::string> subtitle = {};  ///< below the scene's title
    std::shared_ptr<const Look> look;
    std::vector<SheetPlace> places = {};  ///< on the sheet; empty: on none
    bool bare = false;                    ///< its own picture has nothing around its pixels, which are not enlarged
};

/// Some scanlines of a column.
struct Strip {
    std::vector<image::Rgb8> colours;
    CategoryCounts counts;
};

/// The sheet of a scene's columns, and where their own pictures go.
struct Pages {
    const scene::file::Scene& scene;
    std::filesystem::path sheet;         ///< its file
    std::filesystem::path singles = {};  ///< a folder; empty: no column has a picture of its own
    image::SheetSpec spec = {};          ///< without its legend and the size of its cells, which follow
    bool counted = false;                ///< its legend has room for counts
    intersect::process::StopToken stop = {};
};

/// Writes what columns draw. Different columns may be served at the same time, each from top to bottom.
class ColumnWriter {
public:
    /// Opens every file.
    ColumnWriter(Pages pages, std::vector<ColumnSpec> columns);

    [[nodiscard]] const Look& look(std::size_t column) const { return *columns_[column].look; }
    /// Whether any file has it.
    [[nodiscard]] bool shows(std::size_t column) const { return !singles_.empty() || !columns_[column].places.empty(); }
    [[nodiscard]] Strip strip(std::size_t column, std::size_t pixels) const;
    void put(std::size_t column, int y0, const Strip& strip);
    /// Below a cell of the sheet.
    void set_note(SheetPlace place, std::string note) { sheet_->set_note(place.across, place.down, std::move(note)); }
    /// Gives all files their final names.
    void finish();

private:
    [[nodiscard]] std::vector<image::LegendEntry> sheet_legend(bool all) const;
    void open_single(const Pages& pages, const ColumnSpec& column);

    struct Single {
        std::unique_ptr<image::HeatmapWriter> heatmap = {};
        std::unique_ptr<image::PngWriter> bare = {};
    };
    std::size_t width_;
    std::uint64_t pixels_;
    std::vector<ColumnSpec> columns_;
    std::vector<CategoryCounts> counts_;  ///< of each column
    std::vector<Single> singles_;         ///< of each column; empty: none
    std::optional<image::ContactSheet> sheet_;
};

/// A column that is drawn of bands.
template <class Band>
struct PixelColumn {
    ColumnSpec about;
    std::size_t row = 0;  ///< of which it takes the bands
    std::function<void(const Band&, const Look&, Strip&)> draw;
};

/// What `of` says of each pixel of a band, a `PixelValue`.
template <class Band, class Of>
std::function<void(const Band&, const Look&, Strip&)> drawn_by(Of of) {
    return [of](const Band& band, const Look& look, Strip& strip) {
        for (std::size_t i = 0; i < strip.colours.size(); ++i) {
            const PixelValue pixel = of(band, i);
            strip.colours[i] = look.colour(pixel);
            ++strip.counts[pixel.category];
        }
    };
}

template <class Band>
class ColumnFiles {
public:
    ColumnFiles(Pages pages, std::vector<PixelColumn<Band>> columns)
        : columns_(std::move(columns)), writer_(std::move(pages), specs_of(columns_)) {}

    /// So many pixels of a row from line `y0` on. Different rows may come at the same time.
    void take(std::size_t row, const Band& band, int y0, std::size_t pixels) {
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            if (columns_[c].row != row || !writer_.shows(c)) continue;
            Strip strip = writer_.strip(c, pixels);
            columns_[c].draw(band, writer_.look(c), strip);
            writer_.put(c, y0, strip);
        }
    }
    void set_note(SheetPlace place, std::string note) { writer_.set_note(place, std::move(note)); }
    void finish() { writer_.finish(); }

private:
    static std::vector<ColumnSpec> specs_of(const std::vector<PixelColumn<Band>>& columns) {
        std::vector<ColumnSpec> specs;
        for (const PixelColumn<Band>& column : columns) specs.push_back(column.about);
        return specs;
    }
    std::vector<PixelColumn<Band>> columns_;
    ColumnWriter writer_;
};

}  // namespace lostbits::output::pixel
