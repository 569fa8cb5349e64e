// The parts of a line plot that have a place of their own: what a line looks like, the legend, the labels of marks.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::plot {

inline constexpr std::size_t line_colours = 8;
/// Colours, each with as many markers as there are: what series can be told apart by, apart from dashes.
inline constexpr std::size_t look_count = 6 * line_colours;
[[nodiscard]] image::Rgb8 look_colour(std::size_t look);

/// Series that agree in every point, as the one line that is drawn for them.
struct PlotLine {
    const Series* series;
    std::string label;  ///< `schoolbook`, `3 the same: schoolbook, half_b, press`
    image::Rgb8 colour;
    int marker;  ///< 0 for the first eight families, which need none
    std::span<const double> dashes;
};

/// One line for each group of series with the same points, in the order of the series. No two lines have the same
/// colour, marker and dashes as long as there are at most 240.
[[nodiscard]] std::vector<PlotLine> plot_lines(std::span<const Series> series);

/// A filled marker of the given kind about 7 pixels across.
void draw_marker(image::Stroke& stroke, image::Point centre, int kind);

/// A triangle that points to the edge above or below its point.
void draw_edge_triangle(image::Stroke& stroke, image::Point tip, bool up);

inline constexpr double line_thickness = 1.8;
inline constexpr image::Rgb8 envelope_fill{222, 222, 220};
inline constexpr image::Rgb8 envelope_edge{150, 150, 150};
inline constexpr image::Rgb8 shade_fill{236, 230, 216};

/// An area that the legend names: its colour, and that of its upper edge.
struct PlotArea {
    std::string label;
    image::Rgb8 fill, edge;
};

/// Places from `low` on for things that stay in order, thing k `heights[k]` high and as near to `wishes[k]` as those
/// around it allow, the sum of squares considered; the last ends at `high` if there is room for all.
[[nodiscard]] std::vector<double> places_near(std::span<const double> wishes, std::span<const double> heights,
                                              double low, double high);

/// The legend at the right: lines in the order given, areas last.
class PlotLegend {
public:
    struct Room {
        int width, height;
    };
    /// Takes small letters and a second column before it is higher than the room, and at most two fifths of its width.
    PlotLegend(std::span<const PlotLine> lines, std::span<const PlotArea> areas, bool markers, Room room);

    /// Moves each line's entry to where the line ends, in pixels below the legend's top and no further than `room`; a
    /// NaN is no place. Does nothing where there are two columns.
    void align(std::span<const double> ends, int room);
    /// Where the sample of line k is, below the legend's top; nothing where entries are not aligned.
    [[nodiscard]] std::optional<double> sample_of(std::size_t line) const;

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    void draw(image::Canvas& canvas, int x, int y) const;

private:
    struct Entry {
        std::vector<image::TextBitmap> text;
        const PlotLine* line;  // nullptr for an area
        const PlotArea* area;
        int column = 0, y = 0;
    };
    struct Layout {
        int size, columns, column_width;
    };
    void arrange(std::span<const PlotLine> lines, std::span<const PlotArea> areas, const Layout& layout);
    [[nodiscard]] int height_of(const Entry& entry) const;

    std::vector<Entry> entries_;
    bool markers_, aligned_ = false;
    std::vector<int> column_x_;
    int size_ = 0, width_ = 0, height_ = 0;
};

/// The labels of marks in rows above the frame. A label begins at its line and is higher than every line that it
/// spans, so neither labels nor lines cross.
class MarkLabels {
public:
    /// A mark at pixel `x`; the label may reach to pixel `limit`.
    struct Mark {
        double x;
        std::string label;
    };
    MarkLabels(std::vector<Mark> marks, int limit);

    [[nodiscard]] int height() const noexcept { return height_; }

    /// Draws labels and lines; the labels end at `top`, the lines at `foot`.
    void draw(image::Canvas& canvas, int top, int foot) const;

private:
    struct Placed {
        double x;
        std::vector<image::TextBitmap> text;
        int width = 0, height = 0;
        int rise = 0;  // of the label's foot above the frame
    };
    std::vector<Placed> placed_;
    int height_ = 0;
};

}  // namespace lostbits::output::plot
