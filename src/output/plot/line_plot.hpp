// A sweep as a picture: a value against a parameter, for as many forms and formats as there are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/image/image.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

/// One line. The points are joined in their order; x of a line should not fall.
struct Series {
    std::string label;
    std::vector<double> x, y;       ///< a NaN breaks the line; an infinite y lies at the edge, with a triangle
    std::vector<double> low, high;  ///< a band, drawn faint; both empty, or as long as x
    bool dashed = false;
    std::string family = {};  ///< series of one family share colour and marker (a form in two formats); empty = none
    /// Of `look_count`: the colour and marker that it has in every plot, whatever is drawn beside it, but for its
    /// colour where an earlier series has that and there are no more looks than colours; none: the first that no other
    /// series asks for.
    std::optional<std::size_t> look = {};
};

/// A vertical line with a label above the frame: an onset, a prediction.
struct PlotMark {
    double x;
    std::string label;
};

/// A part of the x axis, drawn as a wash behind the lines; the label stands in the legend.
struct PlotShade {
    double from, to;
    std::string label;
};

struct LinePlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    AxisSpec x, y;
    std::vector<Series> series;
    std::optional<Series> envelope = {};  ///< what no form can be better than: grey below it
    std::vector<PlotMark> marks = {};
    std::vector<PlotShade> shades = {};
    std::string nothing = "no data";      ///< stands in the middle where no line has a value
    std::vector<std::string> notes = {};  ///< below the plot, a sentence each
    int width = 1100, height = 620;       ///< the height grows where legend or marks need it
};

/// Writes the plot as a PNG; the same spec gives the same bytes.
///
/// Series with the same points (and band) are drawn once and share one line of the legend, which says how many they
/// are, since many forms agree bit for bit. Each entry of the legend stands as near to the end of its line as the
/// others allow, and a thin line leads there; where the legend needs two columns, it is only sorted as the lines end.
/// Series without a look of their own get colours in their order; when there are more than eight, markers tell them
/// apart. What cannot be drawn is counted in a footnote.
///
/// Throws EnvironmentError for an unwritable file, and std::invalid_argument for x, y and bands of different lengths,
/// ends of axes as AxisRange, and a picture of less than 400 by 200 pixels.
void write_line_plot(const std::filesystem::path& path, const LinePlotSpec& spec);

}  // namespace lostbits::output::plot
