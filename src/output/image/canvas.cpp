// Canvases as pixels, wrapped text, headings, colour bars and legends.
#include "output/image/canvas.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

namespace lostbits::output::image {
namespace {

constexpr int ramp_width = 16;
constexpr int swatch_size = 12;
constexpr int swatch_gap = 6;
constexpr int column_gap = 18;

std::uint8_t blend(std::uint8_t background, std::uint8_t ink, int coverage) {
    return static_cast<std::uint8_t>((background * (255 - coverage) + ink * coverage + 127) / 255);
}

std::string entry_text(const LegendEntry& entry) {
    return entry.count.empty() ? entry.label : entry.label + "  " + entry.count;
}

/// End of the first UTF-8 character that ends at or after byte `n`.
std::size_t character_end(std::string_view text, std::size_t n) {
    while (n < text.size() && (static_cast<unsigned char>(text[n]) & 0xC0) == 0x80) ++n;
    return std::min(n, text.size());
}

/// Largest number of bytes of `text` that fit in `width`, at least one character.
std::size_t fitting_prefix(std::string_view text, int size, FontWeight weight, int width) {
    std::size_t lo = 1, hi = text.size();
    while (lo < hi) {
        const std::size_t middle = (lo + hi + 1) / 2;
        if (image_backend().render_text(text.substr(0, character_end(text, middle)), size, weight).width <= width) {
            lo = middle;
        } else {
            hi = middle - 1;
        }
    }
    return character_end(text, lo);
}

}  // namespace

namespace {

PixelBox intersection(const PixelBox& a, const PixelBox& b) {
    const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
    return {x, y, std::max(std::min(a.x + a.width, b.x + b.width) - x, 0),
            std::max(std::min(a.y + a.height, b.y + b.height) - y, 0)};
}

PixelBox move_box(PixelBox box, int x, int y) {
    box.x += x;
    box.y += y;
    return box;
}

/// Box of the pixels that figures reach. It limits the work, because a marker covers only a few pixels of a large
/// page.
PixelBox figure_bounds(const std::vector<Figure>& figures, const PixelBox& clip) {
    double left = clip.x + clip.width, right = clip.x, top = clip.y + clip.height, foot = clip.y;
    for (const Figure& figure : figures) {
        const double radius = figure.thickness / 2 + 1;
        for (const Point& p : figure.points) {
            left = std::min(left, p.x - radius);
            right = std::max(right, p.x + radius);
            top = std::min(top, p.y - radius);
            foot = std::max(foot, p.y + radius);
        }
    }

    PixelBox box{std::max(clip.x, static_cast<int>(std::floor(left))),
                 std::max(clip.y, static_cast<int>(std::floor(top)))};
    box.width = std::min(clip.x + clip.width, static_cast<int>(std::ceil(right))) - box.x;
    box.height = std::min(clip.y + clip.height, static_cast<int>(std::ceil(foot))) - box.y;
    return box;
}

/// Paints marks into pixels.
class Painter {
public:
    Painter(std::vector<Rgb8>& pixels, int width) : pixels_(pixels), width_(width) {}

    void paint(const CanvasMark::Fill& fill, const CanvasMark& mark) {
        for (const PixelBox& box : fill.boxes)
            for (int y = box.y; y < box.y + box.height; ++y) std::fill_n(&pixel_at(box.x, y), box.width, mark.colour);
    }

    void paint(const CanvasMark::Line& line, const CanvasMark& mark) {
        blend_in({line.x, line.y, line.text.width, line.text.height}, line.text.coverage, mark, 1);
    }

    void paint(const CanvasMark::FigureGroup& group, const CanvasMark& mark) {
        const PixelBox box = figure_bounds(group.figures, mark.clip);
        if (box.width > 0 && box.height > 0)
            blend_in(box, image_backend().cover(group.figures, box), mark, group.opacity);
    }

    void paint(const CanvasMark::Field& field, const CanvasMark& mark) {
        const PixelBox box = intersection(field.box, mark.clip);
        const auto sample = [&](int x, int y) {
            const std::int64_t column = std::int64_t{x - field.box.x} * field.columns / field.box.width,
                               row = std::int64_t{y - field.box.y} * field.rows() / field.box.height;
            return field.samples[row * field.columns + column];
        };
        for (int y = box.y; y < box.y + box.height; ++y)
            for (int x = box.x; x < box.x + box.width; ++x) pixel_at(x, y) = sample(x, y);
    }

private:
    Rgb8& pixel_at(int x, int y) {
        return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
    }

    /// Blends the mark's colour into each pixel of the box, weighted by its coverage.
    void blend_in(const PixelBox& box, std::span<const std::uint8_t> coverage, const CanvasMark& mark, double opacity) {
        const PixelBox visible = intersection(box, mark.clip);
        for (int y = visible.y; y < visible.y + visible.height; ++y) {
            for (int x = visible.x; x < visible.x + visible.width; ++x) {
                const double covered_255 = coverage[(y - box.y) * box.width + x - box.x];
                if (covered_255 == 0) continue;
                const int weight = static_cast<int>(std::lround(covered_255 * opacity));
                Rgb8& pixel = pixel_at(x, y);
                pixel = {blend(pixel.r, mark.colour.r, weight), blend(pixel.g, mark.colour.g, weight),
                         blend(pixel.b, mark.colour.b, weight)};
            }
        }
    }

    std::vector<Rgb8>& pixels_;
    int width_;
};

}  // namespace

Canvas::Canvas(int width, int height, Rgb8 background)
    : width_(std::max(width, 0)), height_(std::max(height, 0)), background_(background) {}

std::vector<Rgb8> Canvas::pixels() const {
    std::vector<Rgb8> pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), background_);
    Painter painter(pixels, width_);
    draw_with([&painter](const auto& shape, const CanvasMark& mark) { painter.paint(shape, mark); });
    return pixels;
}

void Canvas::fill(int x, int y, int width, int height, Rgb8 colour) {
    const PixelBox box = intersection({x, y, width, height}, bounds());
    if (box.width == 0 || box.height == 0) return;
    CanvasMark* const last = marks_.empty() ? nullptr : &marks_.back();
    auto* const last_fill = last ? std::get_if<CanvasMark::Fill>(&last->shape) : nullptr;
    if (last_fill && last->colour == colour && last->data == mark_data_) last_fill->boxes.push_back(box);
    else marks_.push_back({CanvasMark::Fill{{box}}, colour, bounds(), mark_data_});
}

void Canvas::frame(int x, int y, int width, int height, Rgb8 colour) {
    fill(x - 1, y - 1, width + 2, 1, colour);
    fill(x - 1, y + height, width + 2, 1, colour);
    fill(x - 1, y, 1, height, colour);
    fill(x + width, y, 1, height, colour);
}

void Canvas::text(int x, int y, const TextBitmap& text, Rgb8 colour) {
    if (text.width > 0) marks_.push_back({CanvasMark::Line{x, y, text}, colour, bounds(), mark_data_});
}

void Canvas::field(const PixelBox& box, int columns, std::vector<Rgb8> samples) {
    if (box.width > 0 && box.height > 0)
        marks_.push_back({CanvasMark::Field{box, columns, std::move(samples)}, {}, bounds(), mark_data_});
}

void Canvas::draw_figures(const PixelBox& box, std::vector<Figure> figures, Rgb8 colour, double opacity) {
    if (!figures.empty())
        marks_.push_back(
            {CanvasMark::FigureGroup{std::move(figures), opacity}, colour, intersection(box, bounds()), mark_data_});
}

namespace {

void move(CanvasMark::Line& line, int x, int y) {
    line.x += x;
    line.y += y;
}

void move(CanvasMark::FigureGroup& group, int x, int y) {
    for (Figure& figure : group.figures)
        for (Point& point : figure.points) point = {point.x + x, point.y + y};
}

void move(CanvasMark::Field& field, int x, int y) { field.box = move_box(field.box, x, y); }

}  // namespace

void Canvas::draw_canvas(int x, int y, const Canvas& other) {
    for (const CanvasMark& mark : other.marks_) {
        if (const auto* const fill_shape = std::get_if<CanvasMark::Fill>(&mark.shape)) {
            for (const PixelBox& box : fill_shape->boxes)
                fill(box.x + x, box.y + y, box.width, box.height, mark.colour);
            continue;
        }
        CanvasMark& moved_mark = marks_.emplace_back(mark);
        moved_mark.clip = intersection(move_box(mark.clip, x, y), bounds());
        std::visit(
            [&](auto& shape) {
                if constexpr (requires { move(shape, x, y); }) move(shape, x, y);
            },
            moved_mark.shape);
    }
}

void Stroke::polyline(std::span<const Point> points, double thickness, std::span<const double> dashes) {
    figures_.push_back({{points.begin(), points.end()}, thickness, {dashes.begin(), dashes.end()}});
}

void Stroke::area(std::span<const Point> above, std::span<const Point> below) {
    Figure outline{{above.begin(), above.end()}};
    outline.points.insert(outline.points.end(), below.rbegin(), below.rend());
    figures_.push_back(std::move(outline));
}

namespace {

/// Text of each line of `wrap_text`.
std::vector<std::string_view> wrapped_lines(std::string_view text, int size, FontWeight weight, int width) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        // A letter has at most four bytes and is at least a pixel wide. Without this limit, cutting lines off a
        // long text would take quadratic time.
        const auto max_bytes = 4 * static_cast<std::size_t>(std::max(width, 1));
        std::size_t length = fitting_prefix(text.substr(0, character_end(text, max_bytes)), size, weight, width);

        // Breaks between words if possible.
        if (length < text.size()) {
            const std::size_t space = text.substr(0, length + 1).rfind(' ');
            if (space != std::string_view::npos && space > 0) length = space;
        }

        std::string_view line = text.substr(0, length);
        while (line.ends_with(' ')) line.remove_suffix(1);
        if (!line.empty()) lines.push_back(line);
        text.remove_prefix(length);
        while (text.starts_with(' ')) text.remove_prefix(1);
    }
    return lines;
}

}  // namespace

std::vector<TextBitmap> wrap_text(std::string_view text, int size, FontWeight weight, int width) {
    std::vector<TextBitmap> lines;
    for (const std::string_view line : wrapped_lines(text, size, weight, width))
        lines.push_back(image_backend().render_text(line, size, weight));
    return lines;
}

std::vector<TextBitmap> wrap_text_into(std::string_view text, int size, int width, std::size_t max_lines) {
    std::vector<TextBitmap> lines;
    const auto line_texts = wrapped_lines(text, size, FontWeight::regular, width);
    for (std::size_t i = 0; i < std::min(max_lines, line_texts.size()); ++i) {
        // The last line takes the whole rest of the text.
        const auto begin = static_cast<std::size_t>(line_texts[i].data() - text.data());
        const bool is_last = i + 1 == max_lines;
        lines.push_back(fit_text(is_last ? text.substr(begin) : line_texts[i], size, FontWeight::regular, width));
    }
    return lines;
}

TextBitmap fit_text(std::string_view text, int size, FontWeight weight, int width) {
    TextBitmap out = image_backend().render_text(text, size, weight);
    for (int s = size - 1; out.width > width && s >= style::smallest_size; --s) {
        out = image_backend().render_text(text, s, weight);
    }

    // Leaves letters out of the middle, one after the other.
    const int smallest = std::min(size, style::smallest_size);
    for (std::size_t kept_bytes = text.size(); out.width > width && kept_bytes > 1;) {
        --kept_bytes;
        std::string shorter(text.substr(0, character_end(text, (kept_bytes + 1) / 2)));
        shorter += "…";
        shorter += text.substr(character_end(text, text.size() - kept_bytes / 2));
        out = image_backend().render_text(shorter, smallest, weight);
    }
    return out;
}

Canvas heading(std::string_view title, std::span<const std::string> subtitle, int width) {
    struct Line {
        TextBitmap text;
        int height;
        Rgb8 colour;
    };
    std::vector<Line> lines;
    int height = 0;
    const auto add = [&](std::string text, int size, FontWeight weight, Rgb8 colour) {
        // Titles in files may contain line breaks or tabs, which would be drawn as boxes.
        std::ranges::replace_if(
            text, [](char c) { return std::iscntrl(static_cast<unsigned char>(c)); }, ' ');
        for (auto& line : wrap_text(text, size, weight, width)) {
            lines.push_back({std::move(line), style::line_height(size), colour});
            height += style::line_height(size);
        }
    };
    add(std::string(title), style::title_size, FontWeight::bold, style::ink);
    for (const auto& text : subtitle) add(text, style::text_size, FontWeight::regular, style::soft_ink);

    Canvas out(width, height);
    int y = 0;
    for (const auto& line : lines) {
        out.text(0, y, line.text, line.colour);
        y += line.height;
    }
    return out;
}

Canvas colour_bar(const ColourScale& scale, std::string_view label, int height) {
    const int label_height = style::line_height(style::text_size) + 4;
    const int tick_label_half = image_backend().render_text("0", style::text_size).height / 2;
    // The frame and half a label stay inside the strip at the lower end.
    const int top = label_height + tick_label_half, bar_height = std::max(height - top - tick_label_half - 1, 2);

    const TextBitmap label_text = image_backend().render_text(label, style::text_size);
    const auto ticks = scale.ticks(std::clamp(bar_height / 24, 2, 9));
    std::vector<TextBitmap> labels;
    int width = std::max(label_text.width, ramp_width + 2);
    for (const auto& tick : ticks) {
        labels.push_back(image_backend().render_text(tick.label, style::text_size));
        width = std::max(width, 1 + ramp_width + 9 + labels.back().width);
    }

    Canvas out(width, height);
    out.text(0, 0, label_text, style::ink);
    std::vector<Rgb8> ramp;
    for (int y = 0; y < bar_height; ++y)
        ramp.push_back(scale.colour_at_position(1 - static_cast<double>(y) / (bar_height - 1)));
    out.field({1, top, ramp_width, bar_height}, 1, std::move(ramp));
    out.frame(1, top, ramp_width, bar_height, style::line);

    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const int y = top + static_cast<int>((1 - ticks[i].position) * (bar_height - 1) + 0.5);
        out.fill(1 + ramp_width, y, 5, 1, style::soft_ink);
        out.text(1 + ramp_width + 9, y - labels[i].baseline + style::digit_rise(style::text_size), labels[i],
                 style::ink);
    }
    return out;
}

Legend::Legend(std::span<const LegendEntry> widest, int width) : width_(width), capacity_(widest.size()) {
    if (widest.empty()) return;
    for (const auto& entry : widest) {
        const int entry_width =
            swatch_size + 2 + swatch_gap + image_backend().render_text(entry_text(entry), style::text_size).width;
        column_width_ = std::max(column_width_, entry_width);
    }
    column_width_ = std::min(column_width_, width);

    const int count = static_cast<int>(widest.size());
    columns_ = std::clamp((width + column_gap) / (column_width_ + column_gap), 1, count);
    const int row_count = (count + columns_ - 1) / columns_;
    columns_ = (count + row_count - 1) / row_count;  // rows of equal length: 3 + 3 entries rather than 5 + 1
    height_ = row_count * (style::line_height(style::text_size) + 4);
}

Canvas Legend::draw(std::span<const LegendEntry> entries) const {
    if (entries.size() > capacity_) throw std::logic_error("the legend has more entries than were measured");
    Canvas out(width_, height_);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const int x = static_cast<int>(i) % columns_ * (column_width_ + column_gap);
        const int y = static_cast<int>(i) / columns_ * (style::line_height(style::text_size) + 4);
        out.fill(x + 1, y + 3, swatch_size, swatch_size, entries[i].colour);
        out.frame(x + 1, y + 3, swatch_size, swatch_size, style::line);
        const int text_x = x + swatch_size + 2 + swatch_gap;
        const auto text = fit_text(entry_text(entries[i]), style::text_size, FontWeight::regular,
                                   column_width_ - (swatch_size + 2 + swatch_gap));
        out.text(text_x, y + 3 + swatch_size - text.baseline, text, style::ink);
    }
    return out;
}

}  // namespace lostbits::output::image
