// Plots made of coloured cells: a matrix of named rows and columns, and a plane of values over two parameters.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

struct MatrixCell {
    image::Rgb8 colour = image::style::background;
    std::string text = {};  ///< `24/48`, in dark or light ink, whichever contrasts more
};

struct MatrixPlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    struct Group {
        std::string label;                 ///< text above its columns, `f32`
        std::vector<std::string> columns;  ///< names of its columns, written upwards
    };
    std::vector<Group> groups = {};  ///< groups of columns, side by side
    std::vector<std::string> rows = {};
    std::string keys = {};               ///< for a script on a page: what each column shows; see `MarkData`
    std::vector<MatrixCell> cells = {};  ///< row by row, over all groups
    std::vector<image::LegendEntry> legend;
    std::optional<image::ColourScale> scale = {};  ///< drawn as a bar to the right
    std::string bar_label = {};                    ///< text above the bar
};

/// Draws a matrix of coloured cells. Throws std::invalid_argument if there are no cells, or if their number is not rows
/// × columns.
[[nodiscard]] image::Canvas draw_matrix_plot(const MatrixPlotSpec& spec);

/// Cell of one pair of parameters. It shows the colour of an outcome or, without a colour, a value. A NaN without a
/// colour is hatched.
struct PlaneCell {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<image::Rgb8> colour = {};
    bool is_outlined = false;  ///< a line is drawn around neighbouring outlined cells
};

struct PlanePlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    AxisSpec x_axis, y_axis;                    ///< title and scale; the ends follow from the cells
    std::vector<double> x, y;                   ///< the rising parameters of columns (to the right) and rows (upwards)
    std::vector<PlaneCell> cells;               ///< row by row, the row of y[0] first
    std::optional<image::ColourScale> scale;    ///< required if a cell shows its value
    std::string bar_label;                      ///< text above the colour bar: `lost bits`
    std::vector<image::LegendEntry> legend;     ///< the outcomes that occur
    std::string hatching_meaning = "no value";  ///< meaning of hatched cells
};

/// Draws each cell in one flat colour. A cell reaches half-way to its neighbours on the scale of the axis, at least one
/// pixel. A legend entry is added for hatched cells. Throws std::invalid_argument for parameters that do not rise or
/// are not on their axis, a wrong number of cells, or a value without a colour scale.
[[nodiscard]] image::Canvas draw_plane_plot(const PlanePlotSpec& spec);

}  // namespace lostbits::output::plot
