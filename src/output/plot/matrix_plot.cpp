#include "output/plot/matrix_plot.hpp"

#include <algorithm>
#include <stdexcept>

#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

using image::Canvas;
using image::Rgb8;
using image::TextBitmap;

namespace {

constexpr int least_cell_width = 26, cell_room = 6, cell_height = 22, group_gap = 14, beside_label = 8, block_gap = 12;

/// Luminance decides the ink: 0.18 linear is where black and white on a colour have the same contrast.
Rgb8 ink_on(Rgb8 c) {
    const double light =
        (0.2126 * image::linear_light(c.r) + 0.7152 * image::linear_light(c.g) + 0.0722 * image::linear_light(c.b)) /
        65535;
    return light > 0.18 ? image::style::ink : Rgb8{255, 255, 255};
}

std::size_t column_count(const MatrixPlotSpec& spec) {
    std::size_t n = 0;
    for (const auto& g : spec.groups) n += g.columns.size();
    return n;
}

/// Where the left edge of each column lies, from the left edge of the first.
std::vector<int> column_places(const MatrixPlotSpec& spec, int cell_width) {
    std::vector<int> places;
    int x = 0;
    for (const auto& g : spec.groups) {
        for (std::size_t i = 0; i < g.columns.size(); ++i, x += cell_width) places.push_back(x);
        x += group_gap;
    }
    return places;
}

/// Of all cells: that of the widest text.
int width_of_cells(const MatrixPlotSpec& spec) {
    int width = least_cell_width;
    for (const MatrixCell& cell : spec.cells) {
        if (!cell.text.empty())
            width = std::max(width,
                             image::image_backend().render_text(cell.text, image::style::small_size).width + cell_room);
    }
    return width;
}

void draw_cell(Canvas& page, int x, int y, int cell_width, const MatrixCell& cell) {
    page.fill(x, y, cell_width - 1, cell_height - 1, cell.colour);
    if (cell.text.empty()) return;
    const TextBitmap text = image::image_backend().render_text(cell.text, image::style::small_size);
    page.text(x + (cell_width - 1 - text.width) / 2, y + (cell_height - 1 - text.height) / 2, text,
              ink_on(cell.colour));
}

}  // namespace

void write_matrix_plot(const std::filesystem::path& path, const MatrixPlotSpec& spec) {
    const std::size_t columns = column_count(spec);
    if (columns == 0 || spec.rows.empty() || spec.cells.size() != columns * spec.rows.size())
        throw std::invalid_argument(path.string() + ": not one cell per row and column");
    std::vector<TextBitmap> row_labels, column_labels, group_labels;
    int left = 0, head_room = 0;
    for (const auto& r : spec.rows) {
        row_labels.push_back(image::image_backend().render_text(r, image::style::text_size));
        left = std::max(left, row_labels.back().width);
    }
    for (const auto& g : spec.groups) {
        group_labels.push_back(image::image_backend().render_text(g.label, image::style::text_size, true));
        for (const auto& c : g.columns) {
            column_labels.push_back(turned(image::image_backend().render_text(c, image::style::text_size)));
            head_room = std::max(head_room, column_labels.back().height);
        }
    }
    const int cell_width = width_of_cells(spec);
    const auto places = column_places(spec, cell_width);
    const int field_width = places.back() + cell_width, field_height = static_cast<int>(spec.rows.size()) * cell_height;
    const Canvas bar =
        spec.scale ? image::colour_bar(*spec.scale, spec.unit, std::max(field_height, 160)) : Canvas(0, 0);
    const int content = left + beside_label + field_width + (bar.width() > 0 ? block_gap + bar.width() : 0);
    const Canvas head = image::heading(spec.title, spec.subtitle, content);
    const image::Legend legend(spec.legend, content);
    const int x0 = image::style::margin + left + beside_label;
    const int group_y = image::style::margin + head.height() + block_gap;
    const int y0 = group_y + group_labels.front().height + head_room + 2 * beside_label;
    const int below = y0 + std::max(field_height, bar.height()) + block_gap;
    Canvas page(content + 2 * image::style::margin, below + legend.height() + image::style::margin);
    page.picture(image::style::margin, image::style::margin, head);

    std::size_t c = 0;
    for (std::size_t g = 0; g < spec.groups.size(); ++g) {
        page.text(x0 + places[c], group_y, group_labels[g], image::style::ink);
        for (std::size_t k = 0; k < spec.groups[g].columns.size(); ++k, ++c) {
            const TextBitmap& label = column_labels[c];
            page.text(x0 + places[c] + (cell_width - 1 - label.width) / 2, y0 - beside_label / 2 - label.height, label,
                      image::style::ink);
        }
    }
    for (std::size_t r = 0; r < spec.rows.size(); ++r) {
        const int y = y0 + static_cast<int>(r) * cell_height;
        page.text(x0 - beside_label - row_labels[r].width, y + (cell_height - row_labels[r].height) / 2, row_labels[r],
                  image::style::ink);
        for (std::size_t k = 0; k < columns; ++k)
            draw_cell(page, x0 + places[k], y, cell_width, spec.cells[r * columns + k]);
    }
    page.picture(x0 + field_width + block_gap, y0, bar);
    page.picture(image::style::margin, below, legend.draw(spec.legend));
    image::save_png(path, page);
}

}  // namespace lostbits::output::plot
