// A drawing in memory, and the parts that heatmaps and contact sheets share: headings, colour bars and legends.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {

/// Look of every picture: dark ink on a light page.
namespace style {
inline constexpr Rgb8 background{250, 250, 248};
inline constexpr Rgb8 ink{32, 32, 36};
inline constexpr Rgb8 soft_ink{96, 96, 104};
inline constexpr Rgb8 line{176, 176, 180};
inline constexpr int margin = 16;              // pixels around everything
inline constexpr int gap = 14;                 // between parts
inline constexpr int min_content_width = 440;  // space for a title and a legend beside a narrow field
inline constexpr int min_bar_height = 150, max_bar_height = 480;  // of the colour bar, in pixels
inline constexpr int title_size = 18;                             // pixels per em
inline constexpr int text_size = 13;
inline constexpr int small_size = 11;
inline constexpr int smallest_size = 9;  // smaller letters are not legible

inline constexpr int line_height(int size) { return size + (size + 2) / 3; }
/// Distance from the baseline to the middle of the digits, which are 0.73 em high.
inline constexpr int digit_rise(int size) { return size * 73 / 200; }
}  // namespace style

/// Keys and positions of what marks show, for a script on a page. An SVG has them as attributes of a group that
/// contains the marks.
struct MarkData {
    std::string keys;               ///< keys of the rows that the marks show, separated by blanks; empty: none
    std::vector<double> x, y = {};  ///< positions on the canvas: of a point; of steps; of the edges of cells
};

/// One thing that is drawn on a canvas.
struct CanvasMark {
    /// Rectangles of whole pixels.
    struct Fill {
        std::vector<PixelBox> boxes;
    };
    /// A line of text, and its upper left corner.
    struct Line {
        int x, y;
        TextBitmap text;
    };
    /// Figures that are painted as one, so that overlaps are not darker.
    struct FigureGroup {
        std::vector<Figure> figures;
        double opacity;
    };
    /// Samples row by row, stretched to the box: each sample becomes a rectangle of one colour.
    struct Field {
        PixelBox box;
        int columns;
        std::vector<Rgb8> samples;

        [[nodiscard]] int rows() const { return static_cast<int>(samples.size()) / columns; }
    };
    std::variant<Fill, Line, FigureGroup, Field> shape;
    Rgb8 colour;    ///< colour of the shape; unused by a field
    PixelBox clip;  ///< anything outside this box is cut off
    std::shared_ptr<const MarkData> data = {};
};

/// A drawing whose size is a whole number of pixels. It keeps its marks in the order in which they are drawn. Anything
/// outside is cut off.
class Canvas {
public:
    Canvas(int width, int height, Rgb8 background = style::background);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    [[nodiscard]] Rgb8 background() const noexcept { return background_; }

    /// Calls `write(shape, mark)` for each mark, in the order in which the marks are drawn. The writers of PNG, SVG and
    /// PDF use it.
    void draw_with(auto&& write) const {
        for (const CanvasMark& mark : marks_) std::visit([&](const auto& shape) { write(shape, mark); }, mark.shape);
    }
    /// The drawing as pixels, row by row.
    [[nodiscard]] std::vector<Rgb8> pixels() const;

    void fill(int x, int y, int width, int height, Rgb8 colour);
    /// Draws a line one pixel wide just outside the rectangle.
    void frame(int x, int y, int width, int height, Rgb8 colour);
    void text(int x, int y, const TextBitmap& text, Rgb8 colour);
    /// Draws samples row by row, `columns` in a row, each as a rectangle of the box.
    void field(const PixelBox& box, int columns, std::vector<Rgb8> samples);
    /// Blends `colour` into the pixels of the box that the figures cover.
    void draw_figures(const PixelBox& box, std::vector<Figure> figures, Rgb8 colour, double opacity = 1);
    /// Gives `data` to the marks that follow, until the next call.
    void set_mark_data(MarkData data) { mark_data_ = std::make_shared<const MarkData>(std::move(data)); }
    void clear_mark_data() { mark_data_ = nullptr; }
    /// Draws the marks of `other`, cut off at its edges, without its background.
    void draw_canvas(int x, int y, const Canvas& other);

private:
    [[nodiscard]] PixelBox bounds() const noexcept { return {0, 0, width_, height_}; }

    int width_, height_;
    Rgb8 background_;
    std::vector<CanvasMark> marks_;
    std::shared_ptr<const MarkData> mark_data_;
};

/// Collects figures of one colour and paints them together. Otherwise the joints of segments, and points where a line
/// crosses itself, would be darker than the rest. Anything outside the box is cut off.
class Stroke {
public:
    explicit Stroke(const PixelBox& box) : box_(box) {}

    /// Adds segments between the points, `thickness` pixels wide with round ends. `dashes` are alternate lengths of ink
    /// and gap, which run on from segment to segment; empty: solid.
    void polyline(std::span<const Point> points, double thickness, std::span<const double> dashes = {});

    void disc(Point centre, double radius) { figures_.push_back({{centre, centre}, 2 * radius}); }

    void polygon(std::span<const Point> corners) { figures_.push_back({{corners.begin(), corners.end()}}); }

    /// Adds the area between two polylines.
    void area(std::span<const Point> above, std::span<const Point> below);

    /// Draws the figures on the canvas and forgets them.
    void paint(Canvas& canvas, Rgb8 colour, double opacity = 1) {
        canvas.draw_figures(box_, std::exchange(figures_, {}), colour, opacity);
    }

private:
    PixelBox box_;
    std::vector<Figure> figures_;
};

/// Breaks `text` into lines of at most `width` pixels, between words if possible, and inside a word only if the word is
/// wider.
[[nodiscard]] std::vector<TextBitmap> wrap_text(std::string_view text, int size, FontWeight weight, int width);

/// Fits `text` into one line of at most `width` pixels: first with smaller letters, then with `…` in the middle.
[[nodiscard]] TextBitmap fit_text(std::string_view text, int size, FontWeight weight, int width);

/// Breaks `text` into at most `max_lines` lines of `width` pixels. The last line is made by `fit_text`.
[[nodiscard]] std::vector<TextBitmap> wrap_text_into(std::string_view text, int size, int width, std::size_t max_lines);

/// Heading of a picture `width` pixels wide: the title, and smaller lines below it.
[[nodiscard]] Canvas heading(std::string_view title, std::span<const std::string> subtitle, int width);

/// Colour bar with its ticks to the right and its label above, `height` pixels in total.
[[nodiscard]] Canvas colour_bar(const ColourScale& scale, std::string_view label, int height);

/// One class in a legend: its colour, its name and its number of pixels.
struct LegendEntry {
    std::string label;  ///< `false miss`
    Rgb8 colour;
    std::string count;  ///< `1234 (3.1%)`, or empty
};

/// The legend below a picture. Its size is measured before the run, with the widest possible counts; it is drawn after
/// the run, with the actual counts.
class Legend {
public:
    /// `widest` lists every possible entry, each with the widest `count` it can have.
    Legend(std::span<const LegendEntry> widest, int width);

    [[nodiscard]] int height() const noexcept { return height_; }

    /// The legend as a picture of the measured size. Throws std::logic_error for more entries than were measured.
    [[nodiscard]] Canvas draw(std::span<const LegendEntry> entries) const;

private:
    int width_, height_ = 0, columns_ = 1, column_width_ = 1;
    std::size_t capacity_;
};

}  // namespace lostbits::output::image
