// A page with a small picture for every form and format of a scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/figure.hpp"

namespace lostbits::output::image {

/// A small picture of a field, at most 160 pixels on its longer side, made from rows in any order.
/// Larger fields are box-averaged in linear light. Weights and sums are integers, so the result is exact and does not
/// depend on the order of the rows. Colours of categories must not be averaged, because the legend names no mixed
/// colours, so each pixel takes the sample at its middle. Smaller fields are enlarged by a whole factor. Memory does
/// not grow with the field.
class Thumbnail {
public:
    enum class Shrink : std::uint8_t { average, pick };

    Thumbnail(int field_width, int field_height, Shrink shrink = Shrink::average);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }

    /// Adds whole rows of the field, starting at row `y_begin`; each row once. Throws std::logic_error for an
    /// incomplete row or a row outside the field.
    void add_rows(int y_begin, std::span<const Rgb8> samples);

    /// True once every row was added.
    [[nodiscard]] bool is_complete() const noexcept { return added_rows_ == field_height_; }

    /// The picture. Throws std::logic_error before it is complete.
    [[nodiscard]] const std::vector<Rgb8>& pixels() const;

private:
    void add_row(int y, std::span<const Rgb8> samples);
    void pick_row(int y, std::span<const Rgb8> samples);
    void average_row(int y, std::span<const Rgb8> samples);
    void average_sums();

    int field_width_, field_height_, width_, height_;
    Shrink shrink_;
    int factor_ = 0;  ///< factor of enlargement; 0: the field is shrunk
    int added_rows_ = 0;
    /// Pixel into which a column of the field falls, its weight there, and its weight in the next pixel.
    struct Overlap {
        std::size_t pixel;
        std::uint64_t weight, next_weight;
    };
    static std::vector<Overlap> overlaps(std::int64_t field, std::int64_t thumbnail);
    std::vector<Overlap> column_overlaps_, row_overlaps_;
    std::vector<std::uint64_t> row_sums_, pixel_sums_;
    std::vector<Rgb8> pixels_;
};

/// Description of a contact sheet, known before the first pixel.
struct SheetSpec {
    std::string title;
    std::vector<std::string> subtitle;
    std::vector<std::string> column_labels = {};  ///< such as forms
    std::vector<std::string> row_labels = {};     ///< such as formats
    int field_width = 0, field_height = 0;        ///< size of every cell, in samples
    std::vector<ColourScale> scales = {};         ///< empty, or one for all cells, or one for each line of cells
    std::string bar_label = {};                   ///< label over a colour bar
    bool shows_categories = false;                ///< colours stand for categories, so they are not averaged
    std::size_t note_lines = 4;                   ///< number of lines of small text under each cell
    bool collapses = false;                       ///< forms whose cells and texts are all the same share a column
    bool zooms = false;  ///< cells keep their samples, so that `set_zoom` can enlarge some of them
};

/// A grid of thumbnails: forms across and formats down, in blocks of at most seven forms. If forms collapse and still
/// fill several blocks, the first block has six forms: the best, the worst, and those that differ most from the forms
/// chosen before them. Different cells may be filled concurrently, each by one thread. A cell that is never finished
/// is drawn empty, as `not in this format`.
class ContactSheet {
public:
    /// Opens the files of the picture `path`. Throws EnvironmentError, and std::logic_error for a sheet without cells.
    ContactSheet(const std::filesystem::path& path, SheetSpec spec);

    /// Adds rows to the field of one cell, as in Thumbnail::add_rows.
    void add_rows(std::size_t form, std::size_t format, int y_begin, std::span<const Rgb8> samples);

    /// Sets the small text under one cell, such as `4% false miss\np99 3.2 bits`: `note_lines` lines of about 25
    /// letters each. Longer lines are wrapped, and a text of more lines is shortened.
    void set_note(std::size_t form, std::size_t format, std::string note);

    /// Enlarges the samples around column `x` and row `y` of the field, in the corner of the cell that is farthest
    /// away.
    void set_zoom(std::size_t form, std::size_t format, int x, int y);

    /// Draws the page and gives the files their final names. `legend` holds the classes that occur. `order` lists the
    /// indices of the forms in the order in which they are drawn; empty: the given order. `headline` says what the
    /// sheet shows, above the title of the spec; empty: no headline.
    void finish(std::span<const LegendEntry> legend, std::span<const std::size_t> order = {},
                std::string_view headline = {});

private:
    struct Zoom {
        int x, y;
        friend bool operator==(const Zoom&, const Zoom&) = default;
    };
    struct Cell {
        std::optional<Thumbnail> thumbnail;
        std::string note;
        std::vector<Rgb8> samples = {};  ///< samples of the whole field if the sheet zooms
        std::optional<Zoom> zoom = {};
    };
    /// Forms that share a column. The first of them is drawn.
    using FormGroup = std::vector<std::size_t>;
    Cell& cell(std::size_t form, std::size_t format);
    [[nodiscard]] bool look_alike(std::size_t form_a, std::size_t form_b) const;
    [[nodiscard]] std::vector<FormGroup> group_columns(std::span<const std::size_t> order) const;
    [[nodiscard]] std::uint64_t difference(std::size_t form_a, std::size_t form_b) const;
    void move_most_different_first(std::vector<FormGroup>& columns) const;
    [[nodiscard]] int block_y(int block) const;
    [[nodiscard]] int canvas_height(std::size_t columns, const Legend& legend) const;
    void draw_colour_bars();
    void draw_parts(Canvas& canvas, std::size_t columns) const;
    void draw_grid(Canvas& canvas, const std::vector<FormGroup>& columns);
    void draw_bars(Canvas& canvas, std::size_t columns) const;
    void draw_column(Canvas& canvas, int x, int y, const FormGroup& forms);
    [[nodiscard]] std::vector<TextBitmap> wrapped_note(std::string_view note) const;
    void draw_cell(Canvas& canvas, int x, int y, const Cell& cell) const;
    void draw_zoom(Canvas& canvas, int x, int y, const Cell& cell) const;

    SheetSpec spec_;
    std::vector<Cell> cells_;  ///< the forms of the first format, then those of the next
    int thumb_width_, thumb_height_;
    int columns_ = 1, cell_width_ = 0, row_label_width_ = 0, column_head_height_ = 0, row_height_ = 0,
        block_height_ = 0;
    int content_width_ = 0, grid_width_ = 0;
    bool has_selection_block_ = false;  ///< the first block has the six forms that differ most
    Canvas heading_{0, 0};
    std::vector<Canvas> bars_;  ///< one for each scale
    std::unique_ptr<FigureWriter> figure_writer_;
};

}  // namespace lostbits::output::image
