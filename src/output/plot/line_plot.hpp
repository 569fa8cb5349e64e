// Line plots: a value against a parameter, for any number of forms and formats.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

/// One line of the plot. Its points are joined in their order, and x should not fall.
struct Series {
    std::string label;
    std::vector<double> x = {}, y = {};       ///< a NaN breaks the line; an infinite y is a triangle at the edge
    std::vector<double> low = {}, high = {};  ///< ends of a faint band; both empty, or as long as x
    bool is_dashed = false;
    std::string family = {};  ///< series of one family share colour and marker (a form in two formats); empty: none
    /// Index of the look (colour and marker) of the series in every plot, below `look_count`. The series gets another
    /// colour only if an earlier series has this one and there are no more looks than colours. Without an index, the
    /// series gets the first look that no other series requests.
    std::optional<std::size_t> look = {};
    std::string key = {};  ///< for a script on a page: what the line shows; see `MarkData`
};

/// A vertical line with a label above the frame: an onset or a prediction.
struct PlotMark {
    double x;
    std::string label;
};

/// A part of the x axis, drawn as a wash behind the lines. The legend has its label.
struct PlotShade {
    double from, to;
    std::string label;
};

struct LinePlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    AxisSpec x, y;
    std::vector<Series> series = {};
    std::optional<Series> envelope = {};  ///< lower bound for any form; the area below it is grey
    std::vector<PlotMark> marks = {};
    std::vector<PlotShade> shades = {};
    std::string empty_text =
        "no data";  ///< text in place of the plot if there are no lines; or in the middle of it if no line has a value
    std::vector<std::string> notes = {};  ///< sentences below the plot
    int width = 1100, height = 620;       ///< the height grows if legend or marks need it
};

/// Draws the plot. Without lines and envelope it is only a heading and a sentence.
///
/// Many forms agree bit for bit. Series with the same points (and band) are drawn once and share one entry of the
/// legend, which says how many they are. Each entry stands as near to the end of its line as the other entries allow,
/// and a thin line leads there. If the legend needs two columns, its entries are only sorted by the heights at which
/// the lines end. Series without a requested look get colours in their order, and markers after the first eight. A
/// footnote counts what cannot be drawn.
///
/// Throws std::invalid_argument for x, y and bands of different lengths, for ends of axes that AxisRange refuses, and
/// for a picture of less than 400 by 200 pixels.
[[nodiscard]] image::Canvas draw_line_plot(const LinePlotSpec& spec);

}  // namespace lostbits::output::plot
