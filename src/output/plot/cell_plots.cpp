#include "output/plot/cell_plots.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

using image::Canvas;
using image::Rgb8;
using image::TextBitmap;

namespace {

constexpr int min_cell_width = 26, cell_padding = 6, cell_height = 22, group_gap = 14, cell_label_gap = 8,
              block_gap = 12;

/// Black or white ink by luminance. At a relative luminance of 0.18 both have the same contrast.
Rgb8 ink_on(Rgb8 c) {
    const double luminance =
        (0.2126 * image::linear_light(c.r) + 0.7152 * image::linear_light(c.g) + 0.0722 * image::linear_light(c.b)) /
        65535;
    return luminance > 0.18 ? image::style::ink : Rgb8{255, 255, 255};
}

std::size_t count_columns(const MatrixPlotSpec& spec) {
    std::size_t count = 0;
    for (const auto& group : spec.groups) count += group.columns.size();
    return count;
}

/// Left edge of each column, relative to the left edge of the first.
std::vector<int> column_offsets(const MatrixPlotSpec& spec, int cell_width) {
    std::vector<int> offsets;
    int x = 0;
    for (const auto& g : spec.groups) {
        for (std::size_t i = 0; i < g.columns.size(); ++i, x += cell_width) offsets.push_back(x);
        x += group_gap;
    }
    return offsets;
}

/// Width of every cell: it fits the widest text.
int fitting_cell_width(const MatrixPlotSpec& spec) {
    int width = min_cell_width;
    for (const MatrixCell& cell : spec.cells) {
        if (!cell.text.empty())
            width = std::max(
                width, image::image_backend().render_text(cell.text, image::style::small_size).width + cell_padding);
    }
    return width;
}

void draw_cell(Canvas& canvas, int x, int y, int cell_width, const MatrixCell& cell) {
    canvas.fill(x, y, cell_width - 1, cell_height - 1, cell.colour);
    if (cell.text.empty()) return;
    const TextBitmap text = image::image_backend().render_text(cell.text, image::style::small_size);
    canvas.text(x + (cell_width - 1 - text.width) / 2, y + (cell_height - 1 - text.height) / 2, text,
                ink_on(cell.colour));
}

/// Rendered names of the rows, columns and groups, and the space that they need.
struct MatrixLabels {
    std::vector<TextBitmap> rows, columns, groups;
    int row_width = 0, column_height = 0;

    explicit MatrixLabels(const MatrixPlotSpec& spec) {
        for (const auto& r : spec.rows) {
            rows.push_back(image::image_backend().render_text(r, image::style::text_size));
            row_width = std::max(row_width, rows.back().width);
        }
        for (const auto& g : spec.groups) {
            groups.push_back(
                image::image_backend().render_text(g.label, image::style::text_size, image::FontWeight::bold));
            for (const auto& c : g.columns) {
                columns.push_back(rotate_left(image::image_backend().render_text(c, image::style::text_size)));
                column_height = std::max(column_height, columns.back().height);
            }
        }
    }
};

/// Positions of the cells on the page.
struct MatrixLayout {
    int x0, y0;  ///< upper left corner of the first cell
    int cell_width;
    std::vector<int> offsets;  ///< left edge of each column, relative to `x0`

    [[nodiscard]] int row_y(std::size_t row_index) const { return y0 + static_cast<int>(row_index) * cell_height; }
};

/// Draws the names of the groups at `group_y`, and the names of the columns below them.
void draw_column_names(Canvas& canvas, const MatrixPlotSpec& spec, const MatrixLabels& labels,
                       const MatrixLayout& layout, int group_y) {
    std::size_t c = 0;
    for (std::size_t g = 0; g < spec.groups.size(); ++g) {
        canvas.text(layout.x0 + layout.offsets[c], group_y, labels.groups[g], image::style::ink);
        for (std::size_t k = 0; k < spec.groups[g].columns.size(); ++k, ++c) {
            const TextBitmap& label = labels.columns[c];
            canvas.text(layout.x0 + layout.offsets[c] + (layout.cell_width - 1 - label.width) / 2,
                        layout.y0 - cell_label_gap / 2 - label.height, label, image::style::ink);
        }
    }
}

/// Draws the names of the rows and the cells, and tells a script where the cells are.
void draw_matrix_rows(Canvas& canvas, const MatrixPlotSpec& spec, const MatrixLabels& labels,
                      const MatrixLayout& layout) {
    image::MarkData cells{spec.keys, {}};
    for (const int offset : layout.offsets)
        cells.x.insert(cells.x.end(), {layout.x0 + offset + 0.0, layout.x0 + offset + layout.cell_width - 1.0});
    for (std::size_t r = 0; r <= spec.rows.size(); ++r) cells.y.push_back(layout.row_y(r));
    canvas.set_mark_data(std::move(cells));

    const std::size_t columns = layout.offsets.size();
    for (std::size_t r = 0; r < spec.rows.size(); ++r) {
        const int y = layout.row_y(r);
        const TextBitmap& label = labels.rows[r];
        canvas.text(layout.x0 - cell_label_gap - label.width, y + (cell_height - label.height) / 2, label,
                    image::style::ink);
        for (std::size_t k = 0; k < columns; ++k)
            draw_cell(canvas, layout.x0 + layout.offsets[k], y, layout.cell_width, spec.cells[r * columns + k]);
    }
    canvas.clear_mark_data();
}

}  // namespace

Canvas draw_matrix_plot(const MatrixPlotSpec& spec) {
    const std::size_t columns = count_columns(spec);
    if (columns == 0 || spec.rows.empty() || spec.cells.size() != columns * spec.rows.size())
        throw std::invalid_argument("matrix plot: the number of cells is not rows x columns");

    // Measure the labels, the field of cells, the colour bar, the head and the legend.
    const MatrixLabels labels(spec);
    MatrixLayout layout{.x0 = image::style::margin + labels.row_width + cell_label_gap,
                        .y0 = 0,
                        .cell_width = fitting_cell_width(spec),
                        .offsets = {}};
    layout.offsets = column_offsets(spec, layout.cell_width);
    const int field_width = layout.offsets.back() + layout.cell_width;
    const int field_height = static_cast<int>(spec.rows.size()) * cell_height;
    const Canvas bar =
        spec.scale ? image::colour_bar(*spec.scale, spec.bar_label, std::max(field_height, 160)) : Canvas(0, 0);
    const int content_width =
        labels.row_width + cell_label_gap + field_width + (bar.width() > 0 ? block_gap + bar.width() : 0);
    const Canvas head = image::heading(spec.title, spec.subtitle, content_width);
    const image::Legend legend(spec.legend, content_width);

    // Place them below each other.
    const int group_y = image::style::margin + head.height() + block_gap;
    layout.y0 = group_y + labels.groups.front().height + labels.column_height + 2 * cell_label_gap;
    const int legend_y = layout.y0 + std::max(field_height, bar.height()) + block_gap;
    Canvas canvas(content_width + 2 * image::style::margin, legend_y + legend.height() + image::style::margin);
    canvas.draw_canvas(image::style::margin, image::style::margin, head);

    draw_column_names(canvas, spec, labels, layout, group_y);
    draw_matrix_rows(canvas, spec, labels, layout);
    canvas.draw_canvas(layout.x0 + field_width + block_gap, layout.y0, bar);
    canvas.draw_canvas(image::style::margin, legend_y, legend.draw(spec.legend));
    return canvas;
}

namespace {

constexpr int min_width = 560, min_height = 420;  // of the field, in pixels
constexpr image::Rgb8 hatch_paper{240, 240, 238}, hatch_ink{200, 200, 202};
constexpr int hatch_pitch = 6;

double to_scale(AxisSpec::Scale scale, double value) {
    return scale == AxisSpec::Scale::linear ? value
           : scale == AxisSpec::Scale::log2 ? std::log2(value)
                                            : std::log10(value);
}

double from_scale(AxisSpec::Scale scale, double value) {
    return scale == AxisSpec::Scale::linear ? value
           : scale == AxisSpec::Scale::log2 ? std::exp2(value)
                                            : std::pow(10.0, value);
}

/// Edges of the cells: half-way between the parameters, and at the same distance outside the first and last ones.
std::vector<double> cell_edges(const AxisSpec& axis, const std::vector<double>& values) {
    std::vector<double> scaled;
    for (const double value : values) {
        if (!std::isfinite(value) || (axis.scale != AxisSpec::Scale::linear && !(value > 0)) ||
            (!scaled.empty() && !(to_scale(axis.scale, value) > scaled.back()))) {
            throw std::invalid_argument("plane plot: " + axis.title + " does not rise, or is not on its axis");
        }
        scaled.push_back(to_scale(axis.scale, value));
    }

    // A single cell gets some space around its value: a tenth of it, or an octave or a decade.
    const double lone_width = axis.scale == AxisSpec::Scale::linear && scaled[0] != 0 ? std::fabs(scaled[0]) / 5 : 1;
    std::vector<double> edges{scaled.size() > 1 ? scaled[0] - (scaled[1] - scaled[0]) / 2 : scaled[0] - lone_width / 2};
    for (std::size_t i = 1; i < scaled.size(); ++i) edges.push_back(scaled[i - 1] + (scaled[i] - scaled[i - 1]) / 2);
    edges.push_back(scaled.size() > 1 ? scaled.back() + (scaled.back() - scaled[scaled.size() - 2]) / 2
                                      : scaled[0] + lone_width / 2);
    for (double& edge : edges) edge = from_scale(axis.scale, edge);
    return edges;
}

/// Extent of the field in pixels: a whole number of pixels per cell if cells are few.
int field_extent(std::size_t cell_count, int least) {
    const int n = static_cast<int>(cell_count);
    return n >= least ? n : (least + n - 1) / n * n;
}

/// Hatches a box of the field. `phase` is the sum of the field's coordinates on the page.
void draw_hatching(Canvas& field, const image::PixelBox& box, int phase) {
    std::vector<Rgb8> samples;
    for (int y = box.y; y < box.y + box.height; ++y)
        for (int x = box.x; x < box.x + box.width; ++x)
            samples.push_back((x + y + phase) % hatch_pitch == 0 ? hatch_ink : hatch_paper);
    field.field(box, box.width, std::move(samples));
}

/// Draws lines two pixels wide along the inner side of the border of the outlined cells, and a light line outside, so
/// that the lines are visible on every colour. `column` and `row` return the pixel at which a cell begins.
template <class Column, class Row>
void draw_outline(Canvas& canvas, const PlanePlotSpec& spec, Column column, Row row) {
    const std::size_t columns = spec.x.size(), rows = spec.y.size();
    const auto is_outlined = [&](std::size_t i, std::size_t j) {  // the index before 0 wraps to one after the last
        return i < columns && j < rows && spec.cells[j * columns + i].is_outlined;
    };

    // First the light line outside, then the dark line inside.
    struct LinePass {
        image::Rgb8 colour;
        int thickness, outwards;
    };
    for (const auto& [colour, line_width, outset] :
         {LinePass{{255, 255, 255}, 1, 1}, LinePass{image::style::ink, 2, 0}}) {
        for (std::size_t j = 0; j < rows; ++j) {
            for (std::size_t i = 0; i < columns; ++i) {
                if (!is_outlined(i, j)) continue;

                // A side gets a line if the neighbour there is not outlined.
                const int x0 = column(i), x1 = column(i + 1), y0 = row(j + 1), y1 = row(j);
                if (!is_outlined(i - 1, j)) canvas.fill(x0 - outset, y0, line_width, y1 - y0, colour);
                if (!is_outlined(i + 1, j)) canvas.fill(x1 + outset - line_width, y0, line_width, y1 - y0, colour);
                if (!is_outlined(i, j + 1)) canvas.fill(x0, y0 - outset, x1 - x0, line_width, colour);
                if (!is_outlined(i, j - 1)) canvas.fill(x0, y1 + outset - line_width, x1 - x0, line_width, colour);
            }
        }
    }
}

AxisRange axis_range(const AxisSpec& axis, const std::vector<double>& edges) {
    return {{axis.title, axis.scale, edges.front(), edges.back()}, {}};
}

bool is_hatched(const PlaneCell& cell) { return !cell.colour && std::isnan(cell.value); }

void require_valid_cells(const PlanePlotSpec& spec) {
    if (spec.x.empty() || spec.y.empty() || spec.cells.size() != spec.x.size() * spec.y.size())
        throw std::invalid_argument("plane plot: the number of cells is not x values times y values");
    const bool has_value =
        std::ranges::any_of(spec.cells, [](const PlaneCell& c) { return !c.colour && !std::isnan(c.value); });
    if (has_value && !spec.scale)
        throw std::invalid_argument("plane plot: a cell has a value, but there is no colour scale");
}

/// Draws all cells in one picture, because there may be more of them than pixels. `column` and `row` return the pixel
/// at which a cell begins on the page.
template <class Column, class Row>
Canvas draw_plane_cells(const PlanePlotSpec& spec, const PlotFrame& frame, Column column, Row row) {
    Canvas field(frame.width, frame.height);
    for (std::size_t j = 0; j < spec.y.size(); ++j) {
        for (std::size_t i = 0; i < spec.x.size(); ++i) {
            const PlaneCell& cell = spec.cells[j * spec.x.size() + i];
            const int x0 = std::min(column(i) - frame.x, frame.width - 1);
            const int y0 = std::min(row(j + 1) - frame.y, frame.height - 1);
            const int w = std::max(column(i + 1) - frame.x - x0, 1);
            const int h = std::max(row(j) - frame.y - y0, 1);
            if (is_hatched(cell)) {
                draw_hatching(field, {x0, y0, w, h}, frame.x + frame.y);
            } else {
                field.fill(x0, y0, w, h, cell.colour ? *cell.colour : spec.scale->colour_of_value(cell.value));
            }
        }
    }
    return field;
}

}  // namespace

Canvas draw_plane_plot(const PlanePlotSpec& spec) {
    require_valid_cells(spec);

    // Measure the axes, the colour bar, the head and the legend.
    const auto x_edges = cell_edges(spec.x_axis, spec.x), y_edges = cell_edges(spec.y_axis, spec.y);
    const AxisRange x = axis_range(spec.x_axis, x_edges), y = axis_range(spec.y_axis, y_edges);
    PlotFrame frame{0, 0, field_extent(spec.x.size(), min_width), field_extent(spec.y.size(), min_height)};
    const PlotAxes axes(x, y, frame.width, frame.height);
    const Canvas bar = spec.scale ? image::colour_bar(*spec.scale, spec.bar_label, frame.height + 2) : Canvas(0, 0);
    const int right_space = std::max(axes.right_margin(), bar.width() > 0 ? image::style::gap + bar.width() : 0);
    const int content_width = axes.left_margin() + frame.width + 1 + right_space;
    const Canvas head = image::heading(spec.title, spec.subtitle, content_width);
    std::vector<image::LegendEntry> entries = spec.legend;
    if (std::ranges::any_of(spec.cells, is_hatched)) entries.push_back({spec.hatching_meaning, hatch_paper, {}});
    const image::Legend legend(entries, content_width);

    // Place the frame between them.
    frame.x = image::style::margin + axes.left_margin();
    frame.y = image::style::margin + head.height() + (head.height() > 0 ? image::style::gap : 0) + axes.top_margin();
    const int foot = 1 + axes.bottom_margin() + (legend.height() > 0 ? image::style::gap + legend.height() : 0) +
                     image::style::margin;
    Canvas canvas(content_width + 2 * image::style::margin, frame.y + frame.height + foot);
    canvas.draw_canvas(image::style::margin, image::style::margin, head);

    // Draw the cells, and tell a script where they are.
    const auto pixel = [](double position) { return static_cast<int>(std::lround(position)); };
    const auto column = [&](std::size_t i) { return pixel(frame.pixel_x(x.position(x_edges[i]))); };
    const auto row = [&](std::size_t j) { return pixel(frame.pixel_y(y.position(y_edges[j]))); };
    const Canvas field = draw_plane_cells(spec, frame, column, row);
    image::MarkData cells{{}, {}};
    for (std::size_t i = 0; i < x_edges.size(); ++i) cells.x.push_back(column(i));
    for (std::size_t j = 0; j < y_edges.size(); ++j) cells.y.push_back(row(j));
    canvas.set_mark_data(std::move(cells));
    canvas.field({frame.x, frame.y, frame.width, frame.height}, frame.width, field.pixels());
    canvas.clear_mark_data();

    // Draw what lies over them and around them.
    draw_outline(canvas, spec, column, row);
    axes.draw(canvas, frame);
    canvas.draw_canvas(frame.x + frame.width + 1 + image::style::gap, frame.y - 1, bar);
    canvas.draw_canvas(image::style::margin, canvas.height() - image::style::margin - legend.height(),
                       legend.draw(entries));
    return canvas;
}

}  // namespace lostbits::output::plot
