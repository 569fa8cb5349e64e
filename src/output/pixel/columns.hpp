// Columns of pixels and their files: each column is a cell of one sheet and, where asked for, a picture of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "output/file/csv.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/image/heatmap.hpp"
#include "output/pixel/look.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::pixel {

/// A place on one of the sheets.
struct SheetPlace {
    std::size_t across = 0, down = 0, sheet = 0;
};

/// What a column says once: its name, what its pixels are and what the picture of it says.
struct ColumnSpec {
    std::string file;  ///< of its own picture
    std::string title = {};
    std::vector<std::string> subtitle = {};  ///< below the scene's title
    std::shared_ptr<const Look> look;
    std::vector<SheetPlace> places = {};  ///< on sheets; empty: on none
    bool bare = false;                    ///< its own picture has nothing around its pixels, which are not enlarged
    std::string widest_caption = {};      ///< room below its own picture; see `HeatmapSpec`
};

/// Some scanlines of a column.
struct Strip {
    std::vector<image::Rgb8> colours;
    CategoryCounts counts;
};

template <class Bits>
void fields(Bits& bits, Strip& strip) {
    auto& [colours, counts] = strip;
    bits(colours, counts);
}

/// A sheet of columns.
struct Sheet {
    std::filesystem::path file;
    image::SheetSpec spec;  ///< without its legend and the size of its cells, which follow
    bool counted = false;   ///< its legend has room for counts
};

/// Which files of a scene are wished for, and where.
struct SceneFilesOptions {
    std::filesystem::path folder;               ///< of this scene; made if missing
    bool pixels_csv = false;                    ///< also one row per pixel
    std::string command = {};                   ///< what to type to make these files again, for the header of an EXR
    bool singles = false;                       ///< also a picture for each cell of the sheet
    std::vector<file::DataResource> also = {};  ///< other tables in the folder
    std::filesystem::path sheet_alone = {};     ///< a file: the sheet there is all that is written; without a folder

    [[nodiscard]] std::filesystem::path sheet() const {
        return sheet_alone.empty() ? folder / "contact.png" : sheet_alone;
    }
    [[nodiscard]] std::filesystem::path folder_of_singles() const { return singles ? folder : std::filesystem::path(); }
};

/// What is known of a sheet in the end.
struct SheetEnd {
    std::vector<std::size_t> order = {};  ///< of its cells across; see `ContactSheet::finish`
    std::string remark = {};              ///< behind the first entry of its legend
};

/// The sheets of a scene's columns, and where their own pictures go.
struct Pages {
    const scene::file::Scene& scene;
    std::vector<Sheet> sheets;
    std::filesystem::path singles = {};  ///< a folder; empty: no column has a picture of its own
    intersect::process::StopToken stop = {};
    bool opened = true;  ///< else no file is: strips are drawn and kept elsewhere
};

/// Writes what columns draw. Different columns may be served at the same time, each from top to bottom.
class ColumnWriter {
public:
    /// Opens every file.
    ColumnWriter(Pages pages, std::vector<ColumnSpec> columns);

    [[nodiscard]] const Look& look(std::size_t column) const { return *columns_[column].look; }
    /// Whether any file has it.
    [[nodiscard]] bool shows(std::size_t column) const { return has_singles_ || !columns_[column].places.empty(); }
    [[nodiscard]] Strip strip(std::size_t column, std::size_t pixels) const;
    void put(std::size_t column, int y0, const Strip& strip);
    /// Pixels of each category so far.
    [[nodiscard]] const CategoryCounts& counts(std::size_t column) const { return counts_[column]; }
    /// Below a cell of a sheet.
    void set_note(SheetPlace place, std::string note) {
        sheets_[place.sheet]->set_note(place.across, place.down, std::move(note));
    }
    /// Below a column's own picture, where it has room for it.
    void set_caption(std::size_t column, std::string caption) { captions_[column] = std::move(caption); }
    /// Gives all files their final names. `ends`: of each sheet, or none.
    void finish(const std::vector<SheetEnd>& ends = {});

private:
    /// Of one of the sheets, where not `all` only what has a pixel.
    [[nodiscard]] std::vector<image::LegendEntry> sheet_legend(std::size_t sheet, bool all) const;
    void open_single(const Pages& pages, const ColumnSpec& column);
    void finish_single(std::size_t column);

    struct Single {
        std::unique_ptr<image::HeatmapWriter> heatmap = {};
        std::unique_ptr<image::PngWriter> bare = {};
    };
    std::size_t width_;
    std::uint64_t pixels_;
    bool has_singles_;
    std::vector<ColumnSpec> columns_;
    std::vector<CategoryCounts> counts_;  ///< of each column
    std::vector<std::string> captions_;   ///< the same
    std::vector<Single> singles_;         ///< the same; empty: none
    std::vector<std::unique_ptr<image::ContactSheet>> sheets_;
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

    /// What so many pixels of a row are, as each of its columns that a file has draws them.
    [[nodiscard]] std::vector<Strip> draw(std::size_t row, const Band& band, std::size_t pixels) const {
        std::vector<Strip> strips;
        for (const std::size_t c : shown_of(row)) {
            strips.push_back(writer_.strip(c, pixels));
            columns_[c].draw(band, writer_.look(c), strips.back());
        }
        return strips;
    }
    /// The same, from line `y0` on, into the files. Different rows may come at the same time.
    void put(std::size_t row, int y0, const std::vector<Strip>& strips) {
        std::size_t next = 0;
        for (const std::size_t c : shown_of(row)) writer_.put(c, y0, strips.at(next++));
    }
    void take(std::size_t row, const Band& band, int y0, std::size_t pixels) { put(row, y0, draw(row, band, pixels)); }
    [[nodiscard]] ColumnWriter& writer() { return writer_; }

private:
    [[nodiscard]] std::vector<std::size_t> shown_of(std::size_t row) const {
        std::vector<std::size_t> shown;
        for (std::size_t c = 0; c < columns_.size(); ++c)
            if (columns_[c].row == row && writer_.shows(c)) shown.push_back(c);
        return shown;
    }
    static std::vector<ColumnSpec> specs_of(const std::vector<PixelColumn<Band>>& columns) {
        std::vector<ColumnSpec> specs;
        for (const PixelColumn<Band>& column : columns) specs.push_back(column.about);
        return specs;
    }
    std::vector<PixelColumn<Band>> columns_;
    ColumnWriter writer_;
};

}  // namespace lostbits::output::pixel
