// Columns of pixels and their files. A column has one value per pixel of a scene; it is drawn as cells of contact
// sheets and, if the run draws single pictures, as a picture of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "output/file/csv.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/image/heatmap.hpp"
#include "output/pixel/look.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::pixel {

/// Position of a cell on one of the sheets.
struct SheetPosition {
    std::size_t across = 0, down = 0, sheet = 0;
};

/// Description of a column: its file, the texts of its picture, and how its pixels are drawn.
struct ColumnSpec {
    std::string file;  ///< name of the column's own picture
    std::string title = {};
    std::vector<std::string> subtitle = {};  ///< below the scene's title
    std::shared_ptr<const Look> look;
    std::vector<SheetPosition> sheet_positions = {};  ///< cells of sheets that show the column; empty: none
    bool has_only_pixels = false;                     ///< the column's own picture has no texts and is not enlarged
    std::string widest_caption = {};  ///< space for the caption below the column's own picture; see `HeatmapSpec`
};

/// Colours of some scanlines of a column, and the number of pixels of each category in them.
struct Strip {
    std::vector<image::Rgb8> colours;
    CategoryCounts counts;
};

template <class Archive>
void fields(Archive& archive, Strip& strip) {
    auto& [colours, counts] = strip;
    archive(colours, counts);
}

/// File and description of a contact sheet.
struct SheetFile {
    std::filesystem::path file;
    image::SheetSpec spec;  ///< without the size of the cells, which is added later
};

/// Selects the files that are written for a scene, and their folder.
struct SceneFilesOptions {
    std::filesystem::path folder;        ///< the folder of this scene; made if missing
    bool writes_pixels_csv = false;      ///< also a table with one row per pixel
    std::string command = {};            ///< the command that makes these files again, for the header of an EXR
    bool draws_single_pictures = false;  ///< also a picture of its own for each cell of the sheet
    std::vector<file::DataResource> other_tables = {};  ///< further tables in the folder
    std::filesystem::path sheet_only_file = {};         ///< if not empty: only the sheet is written, to this file

    [[nodiscard]] std::filesystem::path sheet() const {
        return sheet_only_file.empty() ? folder / "contact.png" : sheet_only_file;
    }
    [[nodiscard]] std::filesystem::path folder_of_single_pictures() const {
        return draws_single_pictures ? folder : std::filesystem::path();
    }
};

/// Order and texts of a sheet that are known only when all cells are drawn.
struct FinishedSheet {
    std::vector<std::size_t> order = {};  ///< order of the sheet's cells across; see `ContactSheet::finish`
    std::string remark = {};              ///< appended to the first entry of the sheet's legend
    std::string headline = {};            ///< what the sheet shows; see `ContactSheet::finish`
};

/// The files that show the columns of a scene: the contact sheets, and the columns' own pictures.
struct PictureFiles {
    const scene::file::Scene& scene;
    std::vector<SheetFile> sheets;
    std::filesystem::path single_picture_folder = {};  ///< folder of the columns' own pictures; empty: they have none
    intersect::process::StopToken stop = {};
    bool opens_files = true;  ///< false in a shard, which only draws the strips
};

/// Writes the strips that columns draw. Different columns may be written at the same time, each from top to bottom.
class ColumnWriter {
public:
    /// Opens every file.
    ColumnWriter(PictureFiles files, std::vector<ColumnSpec> columns);

    [[nodiscard]] const Look& look(std::size_t column) const { return *columns_[column].look; }
    /// True if any file shows the column.
    [[nodiscard]] bool shows(std::size_t column) const {
        return has_single_pictures_ || !columns_[column].sheet_positions.empty();
    }
    /// A strip of this number of pixels, without colours and counts.
    [[nodiscard]] Strip empty_strip(std::size_t column, std::size_t pixels) const;
    /// Writes the next strip of a column, which begins at scanline `y0`.
    void write_strip(std::size_t column, int y0, const Strip& strip);
    /// Number of pixels of each category that were written so far.
    [[nodiscard]] const CategoryCounts& counts(std::size_t column) const { return counts_[column]; }
    /// Sets the text below a cell of a sheet.
    void set_note(SheetPosition position, std::string note) {
        sheets_[position.sheet]->set_note(position.across, position.down, std::move(note));
    }
    /// Enlarges the pixels around a pixel of a cell.
    void set_zoom(SheetPosition position, int x, int y) {
        sheets_[position.sheet]->set_zoom(position.across, position.down, x, y);
    }
    /// Sets the text below a column's own picture. The picture shows it only if its `widest_caption` reserved space.
    void set_caption(std::size_t column, std::string caption) { captions_[column] = std::move(caption); }
    /// Gives all files their final names. `ends` has one entry per sheet, or is empty.
    void finish(const std::vector<FinishedSheet>& ends = {});

private:
    /// Legend of a sheet: the categories that have a pixel.
    [[nodiscard]] std::vector<image::LegendEntry> make_sheet_legend(std::size_t sheet) const;
    void open_single(const PictureFiles& files, const ColumnSpec& column);
    void finish_single(std::size_t column);

    struct SinglePicture {
        std::unique_ptr<image::HeatmapWriter> heatmap = {};
        std::unique_ptr<image::PngWriter> png = {};
    };
    std::size_t width_;
    std::uint64_t pixels_;
    bool has_single_pictures_;
    std::vector<ColumnSpec> columns_;
    std::vector<CategoryCounts> counts_;          ///< one per column
    std::vector<std::string> captions_;           ///< one per column
    std::vector<SinglePicture> single_pictures_;  ///< one per column, or empty
    std::vector<std::unique_ptr<image::ContactSheet>> sheets_;
};

/// A column, and the function that draws it from the bands of a form.
template <class Band>
struct DrawnColumn {
    ColumnSpec spec;
    std::size_t form_index = 0;  ///< the form of the study whose bands it draws
    std::function<void(const Band&, const Look&, Strip&)> draw;
};

/// Returns a function that draws a band: `pixel_of(band, i)` is the `PixelValue` of pixel i.
template <class Band, class PixelOf>
std::function<void(const Band&, const Look&, Strip&)> make_draw_function(PixelOf pixel_of) {
    return [pixel_of](const Band& band, const Look& look, Strip& strip) {
        for (std::size_t i = 0; i < strip.colours.size(); ++i) {
            const PixelValue pixel = pixel_of(band, i);
            strip.colours[i] = look.colour(pixel);
            ++strip.counts[pixel.category];
        }
    };
}

/// The columns of all forms of a study, and the files that show them.
template <class Band>
class PictureWriter {
public:
    PictureWriter(PictureFiles files, std::vector<DrawnColumn<Band>> columns)
        : columns_(std::move(columns)), writer_(std::move(files), collect_specs(columns_)) {}

    /// Draws this number of pixels of a form, one strip for each column of the form that a file shows.
    [[nodiscard]] std::vector<Strip> draw(std::size_t form_index, const Band& band, std::size_t pixels) const {
        std::vector<Strip> strips;
        for (const std::size_t c : shown_columns(form_index)) {
            strips.push_back(writer_.empty_strip(c, pixels));
            columns_[c].draw(band, writer_.look(c), strips.back());
        }
        return strips;
    }
    /// Writes these strips to the files from scanline `y0` on. Different forms may be written at the same time.
    void write_strips(std::size_t form_index, int y0, const std::vector<Strip>& strips) {
        std::size_t strip_index = 0;
        for (const std::size_t c : shown_columns(form_index)) writer_.write_strip(c, y0, strips.at(strip_index++));
    }
    [[nodiscard]] ColumnWriter& writer() { return writer_; }

private:
    [[nodiscard]] std::vector<std::size_t> shown_columns(std::size_t form_index) const {
        std::vector<std::size_t> shown;
        for (std::size_t c = 0; c < columns_.size(); ++c)
            if (columns_[c].form_index == form_index && writer_.shows(c)) shown.push_back(c);
        return shown;
    }
    static std::vector<ColumnSpec> collect_specs(const std::vector<DrawnColumn<Band>>& columns) {
        std::vector<ColumnSpec> specs;
        for (const DrawnColumn<Band>& column : columns) specs.push_back(column.spec);
        return specs;
    }
    std::vector<DrawnColumn<Band>> columns_;
    ColumnWriter writer_;
};

}  // namespace lostbits::output::pixel
