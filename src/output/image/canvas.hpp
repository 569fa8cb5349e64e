// A picture in memory, text and lines on it, and the parts that heatmaps and contact sheets share.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {

/// Look of every picture: dark ink on a light page.
namespace style {
inline constexpr Rgb8 page{250, 250, 248};
inline constexpr Rgb8 ink{32, 32, 36};
inline constexpr Rgb8 soft_ink{96, 96, 104};
inline constexpr Rgb8 line{176, 176, 180};
inline constexpr int margin = 16;                      // pixels around everything
inline constexpr int gap = 14;                         // between parts
inline constexpr int least_content = 440;              // space for a title and a legend beside a narrow field
inline constexpr int least_bar = 150, most_bar = 480;  // height of the colour bar in pixels
inline constexpr int title_size = 18;                  // pixels per em
inline constexpr int text_size = 13;
inline constexpr int small_size = 11;
inline constexpr int smallest_size = 9;  // smaller letters are not legible

inline constexpr int line_height(int size) { return size + (size + 2) / 3; }
/// Distance from the baseline to the middle of the digits, which are 0.73 em high.
inline constexpr int digit_rise(int size) { return size * 73 / 200; }
}  // namespace style

/// Pixels row by row. Anything drawn outside is cut off.
class Canvas {
public:
    Canvas(int width, int height, Rgb8 colour = style::page);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    [[nodiscard]] std::span<const Rgb8> row(int y) const;
    [[nodiscard]] std::span<const Rgb8> pixels() const noexcept { return pixels_; }

    void set(int x, int y, Rgb8 colour) noexcept;
    void fill(int x, int y, int width, int height, Rgb8 colour) noexcept;
    /// Draws a line one pixel wide just outside the rectangle.
    void frame(int x, int y, int width, int height, Rgb8 colour) noexcept;
    /// Blends `colour` into each pixel of the box, weighted by `coverage`.
    void ink(const PixelBox& box, std::span<const std::uint8_t> coverage, Rgb8 colour, double opacity = 1) noexcept;
    void text(int x, int y, const TextBitmap& text, Rgb8 colour) noexcept {
        ink({x, y, text.width, text.height}, text.coverage, colour);
    }
    void picture(int x, int y, const Canvas& other) noexcept;

private:
    int width_, height_;
    std::vector<Rgb8> pixels_;
};

/// One coat of one colour. Figures are collected and painted together, so that a line that crosses itself and the joint
/// of two segments are not darker than the rest. Anything outside the box is cut off.
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

    /// Blends `colour` into the canvas and forgets the figures.
    void paint(Canvas& canvas, Rgb8 colour, double opacity = 1);

private:
    PixelBox box_;
    std::vector<Figure> figures_;
};

/// Writes the pixels as a PNG. Throws the errors of `ImageBackend::open_png`.
void save_png(const std::filesystem::path& path, const Canvas& canvas);

/// Breaks `text` into lines of at most `width` pixels, between words if possible, and inside a word only if the word is
/// wider.
[[nodiscard]] std::vector<TextBitmap> wrap_text(std::string_view text, int size, bool bold, int width);

/// Fits `text` into one line of at most `width` pixels: first with smaller letters, then with `…` in the middle.
[[nodiscard]] TextBitmap fit_text(std::string_view text, int size, bool bold, int width);

/// Breaks `text` into at most `most` lines of `width` pixels. `fit_text` makes the last one.
[[nodiscard]] std::vector<TextBitmap> wrap_text_into(std::string_view text, int size, int width, std::size_t most);

/// Heading of a picture `width` pixels wide: the title, and smaller lines below it.
[[nodiscard]] Canvas heading(std::string_view title, std::span<const std::string> subtitle, int width);

/// Colour bar with its ticks to the right and its unit above, `height` pixels in total.
[[nodiscard]] Canvas colour_bar(const ColourScale& scale, std::string_view unit, int height);

/// One class in the legend: its colour, its name and its number of pixels.
struct LegendEntry {
    std::string label;  ///< `false miss`
    Rgb8 colour;
    std::string count;  ///< `1234 (3.1%)`, or empty
};

/// The legend below a picture. Its size is measured before the work, with the widest possible counts. It is drawn after
/// the work, with the real ones.
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
