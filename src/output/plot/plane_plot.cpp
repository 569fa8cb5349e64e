#include "output/plot/plane_plot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

using image::Canvas;

namespace {

constexpr int least_width = 560, least_height = 420;  // of the field, in pixels
constexpr image::Rgb8 hatch_paper{240, 240, 238}, hatch_ink{200, 200, 202};
constexpr int hatch_pitch = 6;

double on_scale(AxisSpec::Scale scale, double value) {
    return scale == AxisSpec::Scale::linear ? value
           : scale == AxisSpec::Scale::log2 ? std::log2(value)
                                            : std::log10(value);
}

double off_scale(AxisSpec::Scale scale, double value) {
    return scale == AxisSpec::Scale::linear ? value
           : scale == AxisSpec::Scale::log2 ? std::exp2(value)
                                            : std::pow(10.0, value);
}

/// Where cells begin and end: half-way between the parameters, and as far beyond the outer ones.
std::vector<double> edges_of(const AxisSpec& axis, const std::vector<double>& values) {
    std::vector<double> s;
    for (const double value : values) {
        if (!std::isfinite(value) || (axis.scale != AxisSpec::Scale::linear && !(value > 0)) ||
            (!s.empty() && !(on_scale(axis.scale, value) > s.back()))) {
            throw std::invalid_argument("plane plot: " + axis.title + " does not rise, or leaves its axis");
        }
        s.push_back(on_scale(axis.scale, value));
    }
    // A single cell is given room about its value: a tenth of it, or an octave or a decade.
    const double lone = axis.scale == AxisSpec::Scale::linear && s[0] != 0 ? std::fabs(s[0]) / 5 : 1;
    std::vector<double> out{s.size() > 1 ? s[0] - (s[1] - s[0]) / 2 : s[0] - lone / 2};
    for (std::size_t i = 1; i < s.size(); ++i) out.push_back(s[i - 1] + (s[i] - s[i - 1]) / 2);
    out.push_back(s.size() > 1 ? s.back() + (s.back() - s[s.size() - 2]) / 2 : s[0] + lone / 2);
    for (double& edge : out) edge = off_scale(axis.scale, edge);
    return out;
}

/// The field's extent in pixels: a whole number a cell while cells are few.
int extent(std::size_t cells, int least) {
    const int n = static_cast<int>(cells);
    return n >= least ? n : (least + n - 1) / n * n;
}

void hatch(Canvas& canvas, int x, int y, int width, int height) {
    for (int j = y; j < y + height; ++j) {
        for (int i = x; i < x + width; ++i) canvas.set(i, j, (i + j) % hatch_pitch == 0 ? hatch_ink : hatch_paper);
    }
}

/// Lines two pixels wide on the inner side of the border of the outlined cells, with a light one outside, so that they
/// are seen on every colour. `column` and `row` give the pixel at which a cell begins.
template <class Column, class Row>
void outline(Canvas& page, const PlanePlotSpec& spec, Column column, Row row) {
    const std::size_t columns = spec.x.size(), rows = spec.y.size();
    const auto inside = [&](std::size_t i, std::size_t j) {  // one before 0 wraps to beyond the last
        return i < columns && j < rows && spec.cells[j * columns + i].outlined;
    };
    struct Coat {
        image::Rgb8 colour;
        int thickness, outwards;
    };
    for (const auto& [colour, thick, out] : {Coat{{255, 255, 255}, 1, 1}, Coat{image::style::ink, 2, 0}}) {
        for (std::size_t j = 0; j < rows; ++j) {
            for (std::size_t i = 0; i < columns; ++i) {
                if (!inside(i, j)) continue;
                const int x0 = column(i), x1 = column(i + 1), y0 = row(j + 1), y1 = row(j);
                if (!inside(i - 1, j)) page.fill(x0 - out, y0, thick, y1 - y0, colour);
                if (!inside(i + 1, j)) page.fill(x1 + out - thick, y0, thick, y1 - y0, colour);
                if (!inside(i, j + 1)) page.fill(x0, y0 - out, x1 - x0, thick, colour);
                if (!inside(i, j - 1)) page.fill(x0, y1 + out - thick, x1 - x0, thick, colour);
            }
        }
    }
}

AxisRange range_of(const AxisSpec& axis, const std::vector<double>& edges) {
    return {{axis.title, axis.scale, edges.front(), edges.back()}, {}};
}

}  // namespace

void write_plane_plot(const std::filesystem::path& path, const PlanePlotSpec& spec) {
    if (spec.x.empty() || spec.y.empty() || spec.cells.size() != spec.x.size() * spec.y.size()) {
        throw std::invalid_argument(path.string() + ": not one cell per pair of parameters");
    }
    bool hatched = false;
    for (const auto& cell : spec.cells) {
        hatched |= !cell.colour && std::isnan(cell.value);
        if (!cell.colour && !std::isnan(cell.value) && !spec.scale) {
            throw std::invalid_argument(path.string() + ": a value without a colour scale");
        }
    }
    const auto x_edges = edges_of(spec.x_axis, spec.x), y_edges = edges_of(spec.y_axis, spec.y);
    const AxisRange x = range_of(spec.x_axis, x_edges), y = range_of(spec.y_axis, y_edges);
    PlotFrame frame{0, 0, extent(spec.x.size(), least_width), extent(spec.y.size(), least_height)};
    const PlotAxes axes(x, y, frame.width, frame.height);
    const Canvas bar = spec.scale ? image::colour_bar(*spec.scale, spec.unit, frame.height + 2) : Canvas(0, 0);
    const int beside = std::max(axes.right(), bar.width() > 0 ? image::style::gap + bar.width() : 0);
    const int content = axes.left() + frame.width + 1 + beside;
    const Canvas head = image::heading(spec.title, spec.subtitle, content);
    std::vector<image::LegendEntry> entries = spec.legend;
    if (hatched) entries.push_back({spec.none_means, hatch_paper, {}});
    const image::Legend legend(entries, content);
    frame.x = image::style::margin + axes.left();
    frame.y = image::style::margin + head.height() + (head.height() > 0 ? image::style::gap : 0) + axes.above();
    const int foot =
        1 + axes.below() + (legend.height() > 0 ? image::style::gap + legend.height() : 0) + image::style::margin;
    Canvas page(content + 2 * image::style::margin, frame.y + frame.height + foot);
    page.picture(image::style::margin, image::style::margin, head);

    const auto pixel = [](double place) { return static_cast<int>(std::lround(place)); };
    const auto column = [&](std::size_t i) { return pixel(frame.across(x.position(x_edges[i]))); };
    const auto row = [&](std::size_t j) { return pixel(frame.up(y.position(y_edges[j]))); };
    for (std::size_t j = 0; j < spec.y.size(); ++j) {
        for (std::size_t i = 0; i < spec.x.size(); ++i) {
            const PlaneCell& cell = spec.cells[j * spec.x.size() + i];
            const int x0 = std::min(column(i), frame.x + frame.width - 1);
            const int y0 = std::min(row(j + 1), frame.y + frame.height - 1);
            const int w = std::max(column(i + 1) - x0, 1), h = std::max(row(j) - y0, 1);
            if (cell.colour || !std::isnan(cell.value)) {
                page.fill(x0, y0, w, h, cell.colour ? *cell.colour : spec.scale->map(cell.value));
            } else {
                hatch(page, x0, y0, w, h);
            }
        }
    }
    outline(page, spec, column, row);
    axes.draw(page, frame);
    page.picture(frame.x + frame.width + 1 + image::style::gap, frame.y - 1, bar);
    page.picture(image::style::margin, page.height() - image::style::margin - legend.height(), legend.draw(entries));

    image::save_png(path, page);
}

}  // namespace lostbits::output::plot
