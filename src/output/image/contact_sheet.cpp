// Lays out and draws contact sheets.
#include "output/image/contact_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace lostbits::output::image {
namespace {

constexpr std::size_t max_columns = 7;
constexpr int min_cell_width = 164;   // space for most names of forms
constexpr int line_bar_height = 120;  // height of a line with a bar of its own
constexpr int bar_label_height = 18;  // height of the label over a bar, which reaches above its line
constexpr int block_gap = 10;
constexpr int column_head = 22;  // the name of the form, if it has one line
constexpr int name_line = 16;    // every further line of it
constexpr int note_line = 14;
constexpr std::size_t first_block_forms = 6;  // forms in the first block of a sheet that collapses
constexpr int part_line = 20;                 // height of the line that says which forms a part of the sheet has
constexpr int zoom_pixels = 5;                // size of an enlarged sample
constexpr int zoom_radius = 4;                // samples on each side of the middle one

/// The name of a form in one line if it fits, perhaps in smaller letters. Otherwise a composed name,
/// `FORM^BOX@TRANSFORM`, gets a line for each part, because two such names shortened in the middle look alike.
std::vector<TextBitmap> name_lines(std::string_view name, int width) {
    std::vector<TextBitmap> lines;
    if (image_backend().render_text(name, style::smallest_size, FontWeight::bold).width > width) {
        for (std::size_t next; (next = name.find_first_of("^@~+", 1)) != std::string_view::npos;
             name.remove_prefix(next))
            lines.push_back(fit_text(name.substr(0, next), style::text_size, FontWeight::bold, width));
    }
    lines.push_back(fit_text(name, style::text_size, FontWeight::bold, width));
    return lines;
}

}  // namespace

ContactSheet::ContactSheet(const std::filesystem::path& path, SheetSpec spec)
    : spec_(std::move(spec)), cells_(spec_.column_labels.size() * spec_.row_labels.size()) {
    if (spec_.scales.size() > 1 && spec_.scales.size() != spec_.row_labels.size())
        throw std::logic_error(path.string() + ": neither one colour bar nor one per line");
    if (cells_.empty()) throw std::logic_error(path.string() + ": a contact sheet without cells");
    const Thumbnail thumbnail(spec_.field_width, spec_.field_height);
    thumb_width_ = thumbnail.width();
    thumb_height_ = thumbnail.height();
    cell_width_ = std::max(thumb_width_ + 2, min_cell_width);

    // Make blocks even: 22 forms are 6 + 6 + 6 + 4 rather than 7 + 7 + 7 + 1.
    const std::size_t block_count = (spec_.column_labels.size() + max_columns - 1) / max_columns;
    columns_ = static_cast<int>(spec_.collapses && block_count > 1
                                    ? first_block_forms
                                    : (spec_.column_labels.size() + block_count - 1) / block_count);

    // Sizes of a cell, a line and a block of the grid.
    for (const auto& format : spec_.row_labels) {
        row_label_width_ =
            std::max(row_label_width_, image_backend().render_text(format, style::text_size, FontWeight::bold).width);
    }
    for (const auto& form : spec_.column_labels)
        column_head_height_ = std::max(
            column_head_height_, column_head + name_line * static_cast<int>(name_lines(form, cell_width_).size() - 1));
    const bool has_bar_per_line = spec_.scales.size() > 1;
    row_height_ = std::max(thumb_height_ + 2 + 3 + static_cast<int>(spec_.note_lines) * note_line,
                           has_bar_per_line ? line_bar_height : 0) +
                  style::gap;
    block_height_ = column_head_height_ + static_cast<int>(spec_.row_labels.size()) * row_height_;
    grid_width_ = row_label_width_ + style::gap + columns_ * (cell_width_ + style::gap);

    draw_colour_bars();
    content_width_ = grid_width_;
    if (!bars_.empty()) content_width_ += style::gap + std::ranges::max(bars_, {}, &Canvas::width).width();
    content_width_ = std::max(content_width_, style::min_content_width);
    heading_ = heading(spec_.title, spec_.subtitle, content_width_);
    figure_writer_ = std::make_unique<FigureWriter>(path);
}

/// Draws a bar for each scale, in memory.
void ContactSheet::draw_colour_bars() {
    const bool has_bar_per_line = spec_.scales.size() > 1;
    for (const ColourScale& scale : spec_.scales) {
        const int single_bar_height =
            std::clamp(block_height_ - style::gap - static_cast<int>(spec_.note_lines) * note_line,
                       style::min_bar_height, style::max_bar_height);
        bars_.push_back(colour_bar(
            scale, spec_.bar_label,
            has_bar_per_line ? std::max(line_bar_height, thumb_height_ + bar_label_height) : single_bar_height));
    }
}

ContactSheet::Cell& ContactSheet::cell(std::size_t form, std::size_t format) {
    if (form >= spec_.column_labels.size() || format >= spec_.row_labels.size()) {
        throw std::logic_error("contact sheet: no such cell");
    }
    return cells_[format * spec_.column_labels.size() + form];
}

void ContactSheet::add_rows(std::size_t form, std::size_t format, int y_begin, std::span<const Rgb8> samples) {
    Cell& target = cell(form, format);
    if (!target.thumbnail) {
        target.thumbnail.emplace(spec_.field_width, spec_.field_height,
                                 spec_.shows_categories ? Thumbnail::Shrink::pick : Thumbnail::Shrink::average);
    }
    target.thumbnail->add_rows(y_begin, samples);
    if (!spec_.zooms) return;
    const auto width = static_cast<std::size_t>(spec_.field_width);
    target.samples.resize(width * static_cast<std::size_t>(spec_.field_height));
    std::ranges::copy(samples, target.samples.begin() + static_cast<std::ptrdiff_t>(width) * y_begin);
}

void ContactSheet::set_zoom(std::size_t form, std::size_t format, int x, int y) {
    cell(form, format).zoom = Zoom{x, y};
}

void ContactSheet::set_note(std::size_t form, std::size_t format, std::string note) {
    cell(form, format).note = std::move(note);
}

void ContactSheet::draw_cell(Canvas& canvas, int x, int y, const Cell& cell) const {
    canvas.frame(x + 1, y + 1, thumb_width_, thumb_height_, style::line);
    if (cell.thumbnail && cell.thumbnail->is_complete()) {
        canvas.field({x + 1, y + 1, thumb_width_, thumb_height_}, thumb_width_, cell.thumbnail->pixels());
        if (cell.zoom && !cell.samples.empty()) draw_zoom(canvas, x + 1, y + 1, cell);
    } else {
        const auto text = fit_text("not in this format", style::small_size, FontWeight::regular, thumb_width_ - 4);
        canvas.text(x + 1 + (thumb_width_ - text.width) / 2, y + 1 + (thumb_height_ - text.height) / 2, text,
                    style::soft_ink);
    }

    const auto lines = wrapped_note(cell.note);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        canvas.text(x, y + thumb_height_ + 5 + static_cast<int>(i) * note_line, lines[i], style::soft_ink);
    }
}

void ContactSheet::draw_zoom(Canvas& canvas, int x, int y, const Cell& cell) const {
    const auto window = [](int middle, int side) {
        const int length = std::min(2 * zoom_radius + 1, side);
        return std::pair(std::clamp(middle - zoom_radius, 0, side - length), length);
    };
    const auto [left, columns] = window(cell.zoom->x, spec_.field_width);
    const auto [top, rows] = window(cell.zoom->y, spec_.field_height);
    std::vector<Rgb8> samples;
    for (int row = top; row < top + rows; ++row) {
        const auto begin = cell.samples.begin() + std::ptrdiff_t{row} * spec_.field_width + left;
        samples.insert(samples.end(), begin, begin + columns);
    }

    // A light line inside a dark one is visible on every colour.
    const auto draw_box = [&canvas](int x0, int y0, int width, int height) {
        canvas.frame(x0 - 1, y0 - 1, width + 2, height + 2, style::ink);
        canvas.frame(x0, y0, width, height, style::background);
    };

    // Marks the samples in the thumbnail, and shows them enlarged in the corner farthest from there.
    const auto to_thumbnail = [](int sample, int field, int thumb) {
        return static_cast<int>(std::int64_t{sample} * thumb / field);
    };
    const int from_x = to_thumbnail(left, spec_.field_width, thumb_width_),
              to_x = to_thumbnail(left + columns, spec_.field_width, thumb_width_),
              from_y = to_thumbnail(top, spec_.field_height, thumb_height_),
              to_y = to_thumbnail(top + rows, spec_.field_height, thumb_height_);
    draw_box(x + from_x, y + from_y, to_x - from_x, to_y - from_y);
    const int width = columns * zoom_pixels, height = rows * zoom_pixels;
    const PixelBox inset{x + (from_x + to_x < thumb_width_ ? thumb_width_ - width - 2 : 2),
                         y + (from_y + to_y < thumb_height_ ? thumb_height_ - height - 2 : 2), width, height};
    draw_box(inset.x, inset.y, width, height);
    canvas.field(inset, columns, std::move(samples));
}

std::vector<TextBitmap> ContactSheet::wrapped_note(std::string_view note) const {
    std::vector<TextBitmap> lines;
    std::string_view remaining = note;
    while (!remaining.empty()) {
        const auto line = remaining.substr(0, remaining.find('\n'));
        for (auto& text : wrap_text(line, style::small_size, FontWeight::regular, cell_width_)) {
            lines.push_back(std::move(text));
        }
        remaining.remove_prefix(std::min(line.size() + 1, remaining.size()));
    }
    if (lines.size() <= spec_.note_lines) return lines;

    // The note is too long. Cut it in two near the middle; each half is made smaller or shortened.
    const auto space = note.find_last_of(" \n", note.size() / 2);
    const auto cut = space == std::string_view::npos ? note.size() / 2 : space;
    lines.clear();
    for (const std::string_view half : {note.substr(0, cut), note.substr(cut)}) {
        std::string flat(half.substr(std::min(half.find_first_not_of(" \n"), half.size())));
        std::ranges::replace(flat, '\n', ' ');
        lines.push_back(fit_text(flat, style::small_size, FontWeight::regular, cell_width_));
    }
    return lines;
}

int ContactSheet::canvas_height(std::size_t columns, const Legend& legend) const {
    const int block_count = (static_cast<int>(columns) + columns_ - 1) / columns_,
              grid = block_count * (block_height_ + block_gap) - block_gap,
              bar = bars_.size() == 1 ? bars_.front().height() : 0;
    return block_y(0) + (has_selection_block_ ? part_line : 0) + std::max(grid, bar) + legend.height() + style::margin;
}

int ContactSheet::block_y(int block) const {
    const int line_count = has_selection_block_ ? std::min(block + 1, 2) * part_line : 0;
    return style::margin + heading_.height() + style::gap + line_count + block * (block_height_ + block_gap);
}

bool ContactSheet::look_alike(std::size_t form_a, std::size_t form_b) const {
    for (std::size_t first = 0; first < cells_.size(); first += spec_.column_labels.size()) {
        const Cell &cell_a = cells_[first + form_a], &cell_b = cells_[first + form_b];
        const bool is_drawn = cell_a.thumbnail && cell_a.thumbnail->is_complete();
        if (cell_a.note != cell_b.note || cell_a.zoom != cell_b.zoom ||
            is_drawn != (cell_b.thumbnail && cell_b.thumbnail->is_complete()))
            return false;
        if (is_drawn && cell_a.thumbnail->pixels() != cell_b.thumbnail->pixels()) return false;
    }
    return true;
}

std::vector<ContactSheet::FormGroup> ContactSheet::group_columns(std::span<const std::size_t> order) const {
    std::vector<FormGroup> columns;
    for (std::size_t position = 0; position < spec_.column_labels.size(); ++position) {
        const std::size_t form = order.empty() ? position : order[position];
        const auto shared = std::ranges::find_if(
            columns, [&](const FormGroup& column) { return spec_.collapses && look_alike(column.front(), form); });
        if (shared == columns.end()) columns.push_back({form});
        else shared->push_back(form);
    }
    return columns;
}

/// Sum of the differences of all colours of two forms; cells that are not complete are left out.
std::uint64_t ContactSheet::difference(std::size_t form_a, std::size_t form_b) const {
    const auto channel_difference = [](std::uint8_t x, std::uint8_t y) {
        return static_cast<std::uint64_t>(std::abs(x - y));
    };
    std::uint64_t sum = 0;
    for (std::size_t first = 0; first < cells_.size(); first += spec_.column_labels.size()) {
        const Cell &cell_a = cells_[first + form_a], &cell_b = cells_[first + form_b];
        if (!cell_a.thumbnail || !cell_a.thumbnail->is_complete() || !cell_b.thumbnail ||
            !cell_b.thumbnail->is_complete())
            continue;
        const auto &left = cell_a.thumbnail->pixels(), &right = cell_b.thumbnail->pixels();
        for (std::size_t p = 0; p < left.size(); ++p)
            sum += channel_difference(left[p].r, right[p].r) + channel_difference(left[p].g, right[p].g) +
                   channel_difference(left[p].b, right[p].b);
    }
    return sum;
}

/// Moves six forms to the front: the best, the worst, and those that differ most from the forms chosen before them.
/// Within the six and within the others the order stays.
void ContactSheet::move_most_different_first(std::vector<FormGroup>& columns) const {
    // Distance of each form to the nearest chosen form.
    std::vector<std::uint64_t> distance(columns.size(), std::numeric_limits<std::uint64_t>::max());
    std::vector<bool> is_chosen(columns.size());
    const auto choose = [&](std::size_t k) {
        is_chosen[k] = true;
        for (std::size_t i = 0; i < columns.size(); ++i)
            distance[i] = is_chosen[i] ? 0 : std::min(distance[i], difference(columns[i].front(), columns[k].front()));
    };

    choose(0);
    choose(columns.size() - 1);
    for (std::size_t n = 2; n < first_block_forms; ++n) {
        // Forms with the same picture differ in their texts; the first form that is left is as good as any.
        const auto next = std::ranges::max_element(distance);
        choose(*next > 0 ? static_cast<std::size_t>(next - distance.begin())
                         : static_cast<std::size_t>(std::ranges::find(is_chosen, false) - is_chosen.begin()));
    }

    std::vector<FormGroup> reordered;
    for (const bool chosen : {true, false})
        for (std::size_t k = 0; k < columns.size(); ++k)
            if (is_chosen[k] == chosen) reordered.push_back(std::move(columns[k]));
    columns = std::move(reordered);
}

/// Draws a line above each part of the sheet that says which forms the part has.
void ContactSheet::draw_parts(Canvas& canvas, std::size_t columns) const {
    const std::array<std::string, 2> lines{
        "The six that differ most, from the best to the worst:",
        fmt::format("{}, from the best to the worst:", columns == first_block_forms + 1
                                                           ? "One more"
                                                           : fmt::format("The other {}", columns - first_block_forms))};
    for (int part = 0; part < 2; ++part)
        canvas.text(style::margin, block_y(part) - part_line,
                    image_backend().render_text(lines[part], style::text_size), style::soft_ink);
}

/// Draws one bar beside the first block, or a bar beside each line of every block, as high as its thumbnails.
void ContactSheet::draw_bars(Canvas& canvas, std::size_t columns) const {
    const int x = style::margin + grid_width_ + style::gap;
    if (bars_.size() == 1) return canvas.draw_canvas(x, block_y(0), bars_.front());
    for (std::size_t line = 0; line < bars_.size(); ++line) {
        const int y = column_head_height_ - bar_label_height + static_cast<int>(line) * row_height_;
        for (std::size_t column = 0; column < columns; column += static_cast<std::size_t>(columns_))
            canvas.draw_canvas(x, block_y(static_cast<int>(column) / columns_) + y, bars_[line]);
    }
}

/// Draws the names of the forms and their cells.
void ContactSheet::draw_column(Canvas& canvas, int x, int y, const FormGroup& forms) {
    const auto names = name_lines(spec_.column_labels[forms.front()], cell_width_);
    for (std::size_t i = 0; i < names.size(); ++i)
        canvas.text(x, y + static_cast<int>(i) * name_line, names[i], style::ink);
    if (forms.size() > 1) {
        std::string same_forms = "same:";
        for (const std::size_t form : std::span(forms).subspan(1)) same_forms += " " + spec_.column_labels[form];
        if (image_backend().render_text(same_forms, style::smallest_size).width > cell_width_)
            same_forms = "same: " + std::to_string(forms.size() - 1) + " more forms";
        canvas.text(x, y + static_cast<int>(names.size()) * name_line,
                    fit_text(same_forms, style::small_size, FontWeight::regular, cell_width_), style::soft_ink);
    }
    for (std::size_t format = 0; format < spec_.row_labels.size(); ++format)
        draw_cell(canvas, x, y + column_head_height_ + static_cast<int>(format) * row_height_,
                  cell(forms.front(), format));
}

void ContactSheet::finish(std::span<const LegendEntry> legend, std::span<const std::size_t> order,
                          std::string_view headline) {
    if (!order.empty() && order.size() != spec_.column_labels.size())
        throw std::logic_error("contact sheet: the order does not have every form");
    if (!headline.empty()) {
        spec_.subtitle.insert(spec_.subtitle.begin(), spec_.title);
        heading_ = heading(headline, spec_.subtitle, content_width_);
    }

    // Forms with equal pictures share a column.
    const Legend classes(legend, content_width_);
    auto columns = group_columns(order);
    has_selection_block_ = spec_.collapses && !order.empty() && columns.size() > static_cast<std::size_t>(columns_);
    if (has_selection_block_) move_most_different_first(columns);
    if (columns.size() <
        spec_.column_labels.size()) {  // the names of forms that share a column are a line of their own
        column_head_height_ += name_line;
        block_height_ += name_line;
    }

    Canvas canvas(content_width_ + 2 * style::margin, canvas_height(columns.size(), classes));
    canvas.draw_canvas(style::margin, style::margin, heading_);
    if (has_selection_block_) draw_parts(canvas, columns.size());
    draw_grid(canvas, columns);
    draw_bars(canvas, columns.size());
    canvas.draw_canvas(style::margin, canvas.height() - style::margin - classes.height(), classes.draw(legend));
    figure_writer_->save(canvas);
}

/// Draws the columns, and the names of the formats at the left of each block.
void ContactSheet::draw_grid(Canvas& canvas, const std::vector<FormGroup>& columns) {
    for (std::size_t position = 0; position < columns.size(); ++position) {
        const int column_in_block = static_cast<int>(position) % columns_,
                  y = block_y(static_cast<int>(position) / columns_);
        draw_column(canvas,
                    style::margin + row_label_width_ + style::gap + column_in_block * (cell_width_ + style::gap), y,
                    columns[position]);
        for (std::size_t format = 0; format < spec_.row_labels.size() && column_in_block == 0; ++format) {
            const auto label =
                image_backend().render_text(spec_.row_labels[format], style::text_size, FontWeight::bold);
            canvas.text(
                style::margin,
                y + column_head_height_ + static_cast<int>(format) * row_height_ + (thumb_height_ - label.height) / 2,
                label, style::ink);
        }
    }
}

}  // namespace lostbits::output::image
