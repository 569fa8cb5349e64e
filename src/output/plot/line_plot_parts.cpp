#include "output/plot/line_plot_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lostbits::output::plot {

using image::Point;
using image::Stroke;

namespace {

constexpr int marker_kinds = look_count / line_colours;
constexpr double marker_radius = 3.6;
constexpr int sample_width = 34, sample_gap = 7, column_gap = 16, entry_gap = 4;
constexpr int mark_gap = 8;

}  // namespace

void draw_marker(Stroke& stroke, Point centre, int kind) {
    const double r = marker_radius;
    const auto polygon = [&](std::vector<Point> corners) {
        for (auto& corner : corners) corner = {centre.x + corner.x, centre.y + corner.y};
        stroke.polygon(corners);
    };
    const auto bar = [&](Point a, Point b) {
        const std::array<Point, 2> ends{{{centre.x + a.x, centre.y + a.y}, {centre.x + b.x, centre.y + b.y}}};
        stroke.polyline(ends, line_thickness);
    };
    switch (kind % marker_kinds) {
        case 0: stroke.disc(centre, 3.1); break;
        case 1: polygon({{-3, -3}, {3, -3}, {3, 3}, {-3, 3}}); break;
        case 2: polygon({{0, -r - 1}, {r + 0.6, r - 1}, {-r - 0.6, r - 1}}); break;
        case 3: polygon({{0, -r - 1}, {r, 0}, {0, r + 1}, {-r, 0}}); break;
        case 4:
            bar({-r, -r}, {r, r});
            bar({-r, r}, {r, -r});
            break;
        default: bar({0, -r - 1}, {0, r + 1}); bar({-r - 1, 0}, {r + 1, 0});
    }
}

void draw_edge_triangle(Stroke& stroke, Point tip, bool points_up) {
    const double base = tip.y + (points_up ? 7 : -7);
    stroke.polygon(std::array<Point, 3>{{tip, {tip.x + 4.5, base}, {tip.x - 4.5, base}}});
}

std::vector<double> positions_near(std::span<const double> requests, std::span<const double> heights, double low,
                                   double high) {
    // The heights before each request are subtracted from it. "In order and without overlap" then means "not falling".
    // Neighbours that fall are set to their common mean (pool adjacent violators), which minimizes the sum of squares.
    struct Block {
        double sum;
        std::size_t n;
        [[nodiscard]] double mean() const { return sum / static_cast<double>(n); }
    };

    std::vector<Block> blocks;
    double height_before = 0;
    for (std::size_t k = 0; k < requests.size(); height_before += heights[k++]) {
        blocks.push_back({requests[k] - height_before, 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() > blocks.back().mean()) {
            const Block last = blocks.back();
            blocks.pop_back();
            blocks.back().sum += last.sum;
            blocks.back().n += last.n;
        }
    }

    // Give every request the mean of its block, and add the heights again.
    const double slack = std::max(high - low - height_before, 0.0);
    std::vector<double> positions;
    height_before = 0;
    for (const Block& block : blocks) {
        for (std::size_t k = 0; k < block.n; ++k) {
            positions.push_back(low + std::clamp(block.mean() - low, 0.0, slack) + height_before);
            height_before += heights[positions.size() - 1];
        }
    }
    return positions;
}

PlotLegend::PlotLegend(std::span<const PlotLine> lines, std::span<const PlotArea> areas, bool has_markers,
                       Limits limits)
    : has_markers_(has_markers) {
    struct Attempt {
        int font_size, columns, per_cent;  // the share of the width for all columns is in percent
    };
    for (const auto& [font_size, columns, per_cent] :
         {Attempt{image::style::text_size, 1, 26}, Attempt{12, 1, 26}, Attempt{image::style::small_size, 1, 26},
          Attempt{image::style::small_size, 2, 40}, Attempt{10, 2, 40}}) {
        const int column_width = (limits.width * per_cent / 100 - (columns - 1) * column_gap) / columns;
        arrange(lines, areas, {font_size, columns, column_width});
        if (height_ <= limits.height) return;
    }
}

int PlotLegend::height_of(const Entry& entry) const {
    return std::max<int>(static_cast<int>(entry.text.size()), 1) * image::style::line_height(font_size_) + entry_gap;
}

void PlotLegend::align(std::span<const double> ends, int space) {
    if (column_x_.size() != 1) return;
    const double half = image::style::line_height(font_size_) / 2.0;
    std::vector<double> requests, heights;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
        heights.push_back(height_of(entries_[k]));
        requests.push_back(k < ends.size() && !std::isnan(ends[k]) ? ends[k] - half : space);
    }
    const auto positions = positions_near(requests, heights, 0, std::max(space, height_));
    for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k].y = static_cast<int>(std::lround(positions[k]));
    is_aligned_ = true;
}

std::optional<double> PlotLegend::sample_y(std::size_t line) const {
    if (!is_aligned_) return {};
    return entries_[line].y + font_size_ - image::style::digit_rise(font_size_) + 0.5;
}

void PlotLegend::arrange(std::span<const PlotLine> lines, std::span<const PlotArea> areas, const Layout& layout) {
    const int font_size = layout.font_size, columns = layout.columns;
    entries_.clear();
    font_size_ = font_size;
    const int text_width = std::max(layout.column_width - sample_width - sample_gap, 40);

    // Wrap the labels.
    int total = 0;
    int highest = 0;
    const auto add = [&](const std::string& label, const PlotLine* line, const PlotArea* area) {
        Entry entry{image::wrap_text(label, font_size, image::FontWeight::regular, text_width), line, area};
        highest = std::max(highest, height_of(entry));
        total += height_of(entry);
        entries_.push_back(std::move(entry));
    };
    for (const auto& line : lines) add(line.label, &line, nullptr);
    for (const auto& area : areas) add(area.label, nullptr, &area);

    // Columns of even height: the smallest height that holds all entries in order.
    int height_limit = std::max(total / columns, highest);
    while (fill_columns(height_limit) > columns) height_limit += 2;
    place_columns(columns);
}

int PlotLegend::fill_columns(int height_limit) {
    int column = 0;
    int y = 0;
    height_ = 0;
    for (auto& entry : entries_) {
        const int h = height_of(entry);
        if (y + h > height_limit && y > 0) {
            ++column;
            y = 0;
        }
        entry.column = column;
        entry.y = y;
        y += h;
        height_ = std::max(height_, y);
    }
    return column + 1;
}

void PlotLegend::place_columns(int columns) {
    column_x_.assign(static_cast<std::size_t>(columns), 0);
    width_ = 0;
    for (int column = 0; column < columns; ++column) {
        const int x = width_ + (column > 0 ? column_gap : 0);
        column_x_[column] = x;
        for (const auto& entry : entries_) {
            if (entry.column != column) continue;
            for (const auto& text : entry.text) width_ = std::max(width_, x + sample_width + sample_gap + text.width);
        }
    }
}

void PlotLegend::draw(image::Canvas& canvas, int x0, int y0) const {
    for (const auto& entry : entries_) {
        const int x = x0 + column_x_[entry.column], y = y0 + entry.y;
        int text_y = y;
        for (const auto& text : entry.text) {
            canvas.text(x + sample_width + sample_gap, text_y + font_size_ - text.baseline, text, image::style::ink);
            text_y += image::style::line_height(font_size_);
        }

        // The sample of an area is a box, and the sample of a line a piece of it.
        const double middle = y + font_size_ - image::style::digit_rise(font_size_) + 0.5;
        if (entry.line == nullptr) {
            canvas.fill(x, static_cast<int>(middle) - 5, sample_width, 11, entry.area->fill);
            canvas.fill(x, static_cast<int>(middle) - 5, sample_width, 1, entry.area->edge);
            continue;
        }
        Stroke stroke({x, y - 6, sample_width, image::style::line_height(font_size_) + 12});
        stroke.polyline(std::array<Point, 2>{{{x + 1.5, middle}, {x + sample_width - 1.5, middle}}}, line_thickness,
                        entry.line->dashes);
        if (has_markers_ || entry.line->marker > 0) {
            draw_marker(stroke, {x + sample_width / 2.0, middle}, entry.line->marker);
        }
        stroke.paint(canvas, entry.line->colour);
    }
}

MarkLabels::MarkLabels(std::vector<Mark> marks, int limit) {
    // Wrap the labels between their lines and the limit.
    std::ranges::stable_sort(marks, {}, &Mark::x);
    for (const auto& mark : marks) {
        PlacedLabel label{mark.x, {}};
        const int space = std::max(limit - static_cast<int>(mark.x), 40);
        label.text = image::wrap_text(mark.label, image::style::small_size, image::FontWeight::regular, space);
        for (const auto& text : label.text) {
            label.width = std::max(label.width, text.width);
            label.height += text.height;
        }
        labels_.push_back(std::move(label));
    }

    // Labels are placed from right to left. Each clears the tops of all labels whose lines begin under it.
    for (std::size_t i = labels_.size(); i-- > 0;) {
        PlacedLabel& label = labels_[i];
        label.rise = 3;
        for (std::size_t k = i + 1; k < labels_.size(); ++k) {
            const PlacedLabel& other = labels_[k];
            if (other.x <= label.x + label.width + mark_gap)
                label.rise = std::max(label.rise, other.rise + other.height + 1);
        }
        height_ = std::max(height_, label.rise + label.height + 2);
    }
}

void MarkLabels::draw(image::Canvas& canvas, int top, int foot) const {
    constexpr std::array<double, 2> dashes{4, 3};
    for (const auto& label : labels_) {
        const int x = static_cast<int>(std::floor(label.x));
        const int label_foot = top - label.rise;
        Stroke stroke({x - 2, label_foot, 5, foot - label_foot});
        stroke.polyline(std::array<Point, 2>{{{x + 0.5, label_foot + 0.5}, {x + 0.5, foot + 1.0}}}, 1, dashes);
        stroke.paint(canvas, image::style::soft_ink);
        int y = label_foot - label.height;
        for (const auto& text : label.text) {
            canvas.text(x, y, text, image::style::ink);
            y += text.height;
        }
    }
}

}  // namespace lostbits::output::plot
