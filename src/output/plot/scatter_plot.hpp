// Plot of points with two properties. A stepped line joins the points on the Pareto front, which have labels.
#pragma once

#include <string>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

/// Palette index of the colour of texts (black), for legend entries that explain a marker and not a colour.
inline constexpr std::size_t ink_colour = 4;

struct ScatterPoint {
    double x, y;
    double x_low, x_high;    ///< spread of x, drawn as a thin bar
    int marker = 0;          ///< kind for `draw_marker`
    std::size_t colour = 0;  ///< index in the palette
    bool is_faint = false;   ///< grey, without a bar and a label
    bool is_hollow = false;  ///< the marker has a hole
    std::string label = {};
    std::string script_id = {};  ///< what the point shows, for a script; see `MarkData`
};

struct ScatterPlotSpec {
    std::string title;
    std::vector<std::string> subtitle;
    AxisSpec x, y;
    std::vector<ScatterPoint> points;  ///< a point with a NaN is not drawn, and a footnote counts it
    struct Step {
        double x, y;
        bool is_solid = true;  ///< the line to the next step is solid; otherwise dashed
    };
    std::vector<Step> pareto_front;  ///< x does not fall; the line from a step goes right, then up or down
    struct LegendEntry {
        std::string label;
        int marker;
        std::size_t colour;
        bool is_faint = false, is_hollow = false;
    };
    std::vector<LegendEntry> legend;  ///< below the frame
    int width = 1100, height = 760;
};

[[nodiscard]] image::Canvas draw_scatter_plot(const ScatterPlotSpec& spec);

}  // namespace lostbits::output::plot
