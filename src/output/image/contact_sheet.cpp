#include "output/image/contact_sheet.hpp"

#include <algorithm>
#include <stdexcept>

namespace lostbits::output::image {
namespace {

constexpr std::size_t most_columns = 7;
constexpr int least_cell = 164;  // space for most names of forms
constexpr int line_bar = 120;    // height of a line with a bar of its own
constexpr int unit_height = 18;  // height of the unit over a bar, which reaches above its line
constexpr int block_gap = 10;
constexpr int column_head = 22;  // the name of the form, if it has one line
constexpr int name_line = 16;    // every further line of it
constexpr int note_line = 14;

/// The name of a form in one line if it fits, perhaps in smaller letters. Otherwise a composed name,
/// `FORM^BOX@TRANSFORM`, gets a line for each part, because two such names shortened in the middle look alike.
std::vector<TextBitmap> name_lines(std::string_view name, int width) {
    std::vector<TextBitmap> lines;
    if (image_backend().render_text(name, style::smallest_size, true).width > width) {
        for (std::size_t next; (next = name.find_first_of("^@~+", 1)) != std::string_view::npos;
             name.remove_prefix(next))
            lines.push_back(fit_text(name.substr(0, next), style::text_size, true, width));
    }
    lines.push_back(fit_text(name, style::text_size, true, width));
    return lines;
}

}  // namespace

ContactSheet::ContactSheet(const std::filesystem::path& path, SheetSpec spec)
    : spec_(std::move(spec)), cells_(spec_.forms.size() * spec_.formats.size()) {
    if (spec_.scales.size() > 1 && spec_.scales.size() != spec_.formats.size())
        throw std::logic_error(path.string() + ": neither one colour bar nor one per line");
    if (cells_.empty()) throw std::logic_error(path.string() + ": a contact sheet without cells");
    const Thumbnail size(spec_.field_width, spec_.field_height);
    thumb_width_ = size.width();
    thumb_height_ = size.height();
    cell_width_ = std::max(thumb_width_ + 2, least_cell);

    // Make blocks even: 22 forms are 6 + 6 + 6 + 4 rather than 7 + 7 + 7 + 1.
    const std::size_t blocks = (spec_.forms.size() + most_columns - 1) / most_columns;
    columns_ = static_cast<int>((spec_.forms.size() + blocks - 1) / blocks);
    for (const auto& format : spec_.formats) {
        row_label_width_ =
            std::max(row_label_width_, image_backend().render_text(format, style::text_size, true).width);
    }
    for (const auto& form : spec_.forms)
        head_ = std::max(head_, column_head + name_line * static_cast<int>(name_lines(form, cell_width_).size() - 1));
    const bool bar_a_line = spec_.scales.size() > 1;
    row_height_ =
        std::max(thumb_height_ + 2 + 3 + static_cast<int>(spec_.note_lines) * note_line, bar_a_line ? line_bar : 0) +
        style::gap;
    block_height_ = head_ + static_cast<int>(spec_.formats.size()) * row_height_;
    grid_width_ = row_label_width_ + style::gap + columns_ * (cell_width_ + style::gap);

    int content = grid_width_;
    int bar_width = 0;
    for (const ColourScale& scale : spec_.scales) {
        const int one = std::clamp(block_height_ - style::gap - static_cast<int>(spec_.note_lines) * note_line,
                                   style::least_bar, style::most_bar);
        bars_.push_back(
            colour_bar(scale, spec_.unit, bar_a_line ? std::max(line_bar, thumb_height_ + unit_height) : one));
        bar_width = std::max(bar_width, bars_.back().width());
    }
    if (!bars_.empty()) content += style::gap + bar_width;
    content = std::max(content, style::least_content);
    heading_ = heading(spec_.title, spec_.subtitle, content);
    legend_.emplace(spec_.legend, content);
    page_width_ = content + 2 * style::margin;
    files_ = std::make_unique<FigureFiles>(path);
}

ContactSheet::Cell& ContactSheet::cell(std::size_t form, std::size_t format) {
    if (form >= spec_.forms.size() || format >= spec_.formats.size()) {
        throw std::logic_error("contact sheet: no such cell");
    }
    return cells_[format * spec_.forms.size() + form];
}

void ContactSheet::add_rows(std::size_t form, std::size_t format, int y_begin, std::span<const Rgb8> samples) {
    Cell& target = cell(form, format);
    if (!target.thumbnail) {
        target.thumbnail.emplace(spec_.field_width, spec_.field_height,
                                 spec_.categories ? Thumbnail::Shrink::pick : Thumbnail::Shrink::average);
    }
    target.thumbnail->add_rows(y_begin, samples);
}

void ContactSheet::set_note(std::size_t form, std::size_t format, std::string note) {
    cell(form, format).note = std::move(note);
}

void ContactSheet::draw_cell(Canvas& page, int x, int y, const Cell& cell) const {
    page.frame(x + 1, y + 1, thumb_width_, thumb_height_, style::line);
    if (cell.thumbnail && cell.thumbnail->complete()) {
        page.field({x + 1, y + 1, thumb_width_, thumb_height_}, thumb_width_, cell.thumbnail->pixels());
    } else {
        const auto text = fit_text("not in this format", style::small_size, false, thumb_width_ - 4);
        page.text(x + 1 + (thumb_width_ - text.width) / 2, y + 1 + (thumb_height_ - text.height) / 2, text,
                  style::soft_ink);
    }
    const auto lines = note_of(cell.note);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        page.text(x, y + thumb_height_ + 5 + static_cast<int>(i) * note_line, lines[i], style::soft_ink);
    }
}

std::vector<TextBitmap> ContactSheet::note_of(std::string_view note) const {
    std::vector<TextBitmap> lines;
    std::string_view rest = note;
    while (!rest.empty()) {
        const auto line = rest.substr(0, rest.find('\n'));
        for (auto& text : wrap_text(line, style::small_size, false, cell_width_)) {
            lines.push_back(std::move(text));
        }
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    }
    if (lines.size() <= spec_.note_lines) return lines;
    // The note is too long. Cut it in two near the middle; each half is made smaller or shortened.
    const auto space = note.find_last_of(" \n", note.size() / 2);
    const auto cut = space == std::string_view::npos ? note.size() / 2 : space;
    lines.clear();
    for (const std::string_view half : {note.substr(0, cut), note.substr(cut)}) {
        std::string flat(half.substr(std::min(half.find_first_not_of(" \n"), half.size())));
        std::ranges::replace(flat, '\n', ' ');
        lines.push_back(fit_text(flat, style::small_size, false, cell_width_));
    }
    return lines;
}

int ContactSheet::page_height(std::size_t columns) const {
    const int blocks = (static_cast<int>(columns) + columns_ - 1) / columns_,
              grid = blocks * (block_height_ + block_gap) - block_gap,
              bar = bars_.size() == 1 ? bars_.front().height() : 0;
    return style::margin + heading_.height() + style::gap + std::max(grid, bar) + legend_->height() + style::margin;
}

bool ContactSheet::are_alike(std::size_t a, std::size_t b) const {
    for (std::size_t first = 0; first < cells_.size(); first += spec_.forms.size()) {
        const Cell &one = cells_[first + a], &other = cells_[first + b];
        const bool is_drawn = one.thumbnail && one.thumbnail->complete();
        if (one.note != other.note || is_drawn != (other.thumbnail && other.thumbnail->complete())) return false;
        if (is_drawn && one.thumbnail->pixels() != other.thumbnail->pixels()) return false;
    }
    return true;
}

std::vector<ContactSheet::Alike> ContactSheet::columns_of(std::span<const std::size_t> order) const {
    std::vector<Alike> columns;
    for (std::size_t place = 0; place < spec_.forms.size(); ++place) {
        const std::size_t form = order.empty() ? place : order[place];
        const auto same = std::ranges::find_if(
            columns, [&](const Alike& column) { return spec_.collapses && are_alike(column.front(), form); });
        if (same == columns.end()) columns.push_back({form});
        else same->push_back(form);
    }
    return columns;
}

/// Draws one bar beside the first block, or one beside each line of every block, as high as its thumbnails.
void ContactSheet::draw_bars(Canvas& page, int top, std::size_t columns) const {
    const int x = style::margin + grid_width_ + style::gap;
    if (bars_.size() == 1) return page.picture(x, top, bars_.front());
    for (std::size_t line = 0; line < bars_.size(); ++line) {
        const int y = top + head_ - unit_height + static_cast<int>(line) * row_height_;
        for (std::size_t column = 0; column < columns; column += static_cast<std::size_t>(columns_)) {
            const int block = static_cast<int>(column) / columns_;
            page.picture(x, y + block * (block_height_ + block_gap), bars_[line]);
        }
    }
}

/// Draws the names of the forms and their cells.
void ContactSheet::draw_column(Canvas& page, int x, int y, const Alike& forms) {
    const auto names = name_lines(spec_.forms[forms.front()], cell_width_);
    for (std::size_t i = 0; i < names.size(); ++i)
        page.text(x, y + static_cast<int>(i) * name_line, names[i], style::ink);
    if (forms.size() > 1) {
        std::string same = "same:";
        for (const std::size_t form : std::span(forms).subspan(1)) same += " " + spec_.forms[form];
        page.text(x, y + static_cast<int>(names.size()) * name_line,
                  fit_text(forms.size() > 3 ? "same: " + std::to_string(forms.size() - 1) + " more forms" : same,
                           style::small_size, false, cell_width_),
                  style::soft_ink);
    }
    for (std::size_t format = 0; format < spec_.formats.size(); ++format)
        draw_cell(page, x, y + head_ + static_cast<int>(format) * row_height_, cell(forms.front(), format));
}

void ContactSheet::finish(std::span<const LegendEntry> legend, std::span<const std::size_t> order,
                          std::string_view headline) {
    if (!order.empty() && order.size() != spec_.forms.size())
        throw std::logic_error("contact sheet: the order does not have every form");
    if (!headline.empty()) {
        spec_.subtitle.insert(spec_.subtitle.begin(), spec_.title);
        heading_ = heading(headline, spec_.subtitle, heading_.width());
    }
    const auto columns = columns_of(order);
    if (columns.size() < spec_.forms.size()) {  // the names of forms that share a column are a line of their own
        head_ += name_line;
        block_height_ += name_line;
    }
    Canvas page(page_width_, page_height(columns.size()));
    page.picture(style::margin, style::margin, heading_);
    const int top = style::margin + heading_.height() + style::gap;
    for (std::size_t place = 0; place < columns.size(); ++place) {
        const int across = static_cast<int>(place) % columns_,
                  y = top + static_cast<int>(place) / columns_ * (block_height_ + block_gap);
        draw_column(page, style::margin + row_label_width_ + style::gap + across * (cell_width_ + style::gap), y,
                    columns[place]);
        for (std::size_t format = 0; format < spec_.formats.size() && across == 0; ++format) {
            const auto label = image_backend().render_text(spec_.formats[format], style::text_size, true);
            page.text(style::margin,
                      y + head_ + static_cast<int>(format) * row_height_ + (thumb_height_ - label.height) / 2, label,
                      style::ink);
        }
    }
    draw_bars(page, top, columns.size());
    page.picture(style::margin, page.height() - style::margin - legend_->height(), legend_->draw(legend));
    files_->save(page);
}

}  // namespace lostbits::output::image
