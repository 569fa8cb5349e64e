// A table as a picture: named rows against named columns, a colour and perhaps a word in each cell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"

namespace lostbits::output::plot {

struct MatrixCell {
    image::Rgb8 colour = image::style::page;
    std::string text = {};  ///< `24/48`; in dark or light ink, whichever is read better
};

struct MatrixPlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    struct Group {
        std::string label;                 ///< above its columns, `f32`
        std::vector<std::string> columns;  ///< written upwards below it
    };
    std::vector<Group> groups;  ///< side by side
    std::vector<std::string> rows;
    std::vector<MatrixCell> cells;  ///< row by row, over all groups
    std::vector<image::LegendEntry> legend;
    std::optional<image::ColourScale> scale = {};  ///< drawn as a bar to the right
    std::string unit = {};                         ///< above the bar
};

/// Writes the picture as a PNG; the same spec gives the same bytes. Throws EnvironmentError for an unwritable file, and
/// std::invalid_argument for a wrong number of cells or none.
void write_matrix_plot(const std::filesystem::path& path, const MatrixPlotSpec& spec);

}  // namespace lostbits::output::plot
