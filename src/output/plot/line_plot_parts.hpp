// Parts of a line plot: looks of lines, the legend, and the labels of marks.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::plot {

inline constexpr std::size_t line_colours = 8;
/// Number of looks: colours times markers. Dashes distinguish more series.
inline constexpr std::size_t look_count = 6 * line_colours;
[[nodiscard]] image::Rgb8 look_colour(std::size_t look);

/// One line of the plot, which stands for all series that agree in every point.
struct PlotLine {
    const Series* series;
    std::string label;  ///< `schoolbook`, `3 alike: schoolbook, half_b, press`
    image::Rgb8 colour;
    int marker;  ///< kind of marker; 0 for the first eight looks, which need none
    std::span<const double> dashes;
    std::string keys = {};  ///< keys of its series
};

/// One line for each group of series with the same points, in the order of the series. No two lines have the same
/// colour, marker and dashes if there are at most 240 of them.
[[nodiscard]] std::vector<PlotLine> plot_lines(std::span<const Series> series);

/// Draws a filled marker of the given kind, about 7 pixels across.
void draw_marker(image::Stroke& stroke, image::Point centre, int kind);

/// Draws a triangle at the upper or lower edge, whose tip points to that edge.
void draw_edge_triangle(image::Stroke& stroke, image::Point tip, bool points_up);

inline constexpr double line_thickness = 1.8;
inline constexpr image::Rgb8 envelope_fill{222, 222, 220};
inline constexpr image::Rgb8 envelope_edge{150, 150, 150};
inline constexpr image::Rgb8 shade_fill{236, 230, 216};

/// An area that the legend names, with its colour and the colour of its upper edge.
struct PlotArea {
    std::string label;
    image::Rgb8 fill, edge;
};

/// Positions from `low` on for items that stay in order and do not overlap. Item k has height `heights[k]` and lies as
/// near to `requests[k]` as the other items allow, by least squares. The last one ends at or before `high` if there is
/// space for all.
[[nodiscard]] std::vector<double> positions_near(std::span<const double> requests, std::span<const double> heights,
                                                 double low, double high);

/// The legend at the right: lines in the given order, areas last.
class PlotLegend {
public:
    struct Limits {
        int width, height;
    };
    /// If the legend would exceed the height of `limits`, it gets smaller letters and then a second column. It takes at
    /// most two fifths of the width of `limits`.
    PlotLegend(std::span<const PlotLine> lines, std::span<const PlotArea> areas, bool has_markers, Limits limits);

    /// Moves the entry of each line towards the end of the line. `ends` are in pixels below the top of the legend and
    /// at most `space`; NaN means that a line has no end. Does nothing if there are two columns.
    void align(std::span<const double> ends, int space);
    /// Height of the sample of a line, in pixels below the top of the legend; nothing if entries are not aligned.
    [[nodiscard]] std::optional<double> sample_y(std::size_t line) const;

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    void draw(image::Canvas& canvas, int x, int y) const;

private:
    struct Entry {
        std::vector<image::TextBitmap> text;
        const PlotLine* line;  // null for an area
        const PlotArea* area;
        int column = 0, y = 0;
    };
    struct Layout {
        int font_size, columns, column_width;
    };
    void arrange(std::span<const PlotLine> lines, std::span<const PlotArea> areas, const Layout& layout);
    /// Places the entries below each other, in columns of at most this height. Returns the number of columns.
    int fill_columns(int height_limit);
    /// Places the columns side by side, each as wide as its widest entry.
    void place_columns(int columns);
    [[nodiscard]] int height_of(const Entry& entry) const;

    std::vector<Entry> entries_;
    bool has_markers_, is_aligned_ = false;
    std::vector<int> column_x_;
    int font_size_ = 0, width_ = 0, height_ = 0;
};

/// Labels of marks in rows above the frame. A label begins at its line and lies above every line that it spans, so
/// neither labels nor lines cross.
class MarkLabels {
public:
    /// A mark at pixel `x`. Its label may reach to pixel `limit`.
    struct Mark {
        double x;
        std::string label;
    };
    MarkLabels(std::vector<Mark> marks, int limit);

    [[nodiscard]] int height() const noexcept { return height_; }

    /// Draws labels and lines. The labels end at `top`, the lines at `foot`.
    void draw(image::Canvas& canvas, int top, int foot) const;

private:
    struct PlacedLabel {
        double x;
        std::vector<image::TextBitmap> text;
        int width = 0, height = 0;
        int rise = 0;  // height of the label's foot above the frame
    };
    std::vector<PlacedLabel> labels_;
    int height_ = 0;
};

}  // namespace lostbits::output::plot
