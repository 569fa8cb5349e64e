// A value over a plane of two parameters, with the parameters' values at the axes.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

/// One pair of parameters: an outcome's colour, or else a value; a NaN without a colour is left hatched.
struct PlaneCell {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<image::Rgb8> colour = {};
    bool outlined = false;  ///< a line is drawn around neighbouring cells that are
};

struct PlanePlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    AxisSpec x_axis, y_axis;                  ///< title and scale; the ends follow from the cells
    std::vector<double> x, y;                 ///< the parameters of columns (to the right) and rows (upwards), rising
    std::vector<PlaneCell> cells;             ///< row by row, the row of y[0] first
    std::optional<image::ColourScale> scale;  ///< required where a cell shows its value
    std::string unit;                         ///< over the colour bar: `lost bits`
    std::vector<image::LegendEntry> legend;   ///< the outcomes that occur
    std::string none_means = "no value";      ///< what hatched cells are
};

/// Writes the plot as a PNG; the same spec gives the same bytes. A cell reaches half-way to its neighbours on the
/// scale of the axis, at least one pixel, and has one flat colour; a legend entry is added for hatched cells.
///
/// Throws EnvironmentError for an unwritable file, and std::invalid_argument for parameters that do not rise or have
/// no place on their axis, a wrong number of cells, and a value without a colour scale.
void write_plane_plot(const std::filesystem::path& path, const PlanePlotSpec& spec);

}  // namespace lostbits::output::plot
