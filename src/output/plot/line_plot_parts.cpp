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

void draw_marker(Stroke& stroke, Point c, int kind) {
    const double r = marker_radius;
    const auto polygon = [&](std::vector<Point> corners) {
        for (auto& corner : corners) corner = {c.x + corner.x, c.y + corner.y};
        stroke.polygon(corners);
    };
    const auto bar = [&](Point a, Point b) {
        const std::array<Point, 2> ends{{{c.x + a.x, c.y + a.y}, {c.x + b.x, c.y + b.y}}};
        stroke.polyline(ends, line_thickness);
    };
    switch (kind % marker_kinds) {
        case 0: stroke.disc(c, 3.1); break;
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

void draw_edge_triangle(Stroke& stroke, Point tip, bool up) {
    const double base = tip.y + (up ? 7 : -7);
    stroke.polygon(std::array<Point, 3>{{tip, {tip.x + 4.5, base}, {tip.x - 4.5, base}}});
}

std::vector<double> places_near(std::span<const double> requests, std::span<const double> heights, double low,
                                double high) {
    // Subtract from each wish the heights before it. "In order and without overlap" then means "not falling". Falling
    // neighbours take their common mean (pool adjacent violators), which minimizes the sum of squares.
    struct Block {
        double sum;
        std::size_t n;
        [[nodiscard]] double mean() const { return sum / static_cast<double>(n); }
    };
    std::vector<Block> blocks;
    double before = 0;
    for (std::size_t k = 0; k < requests.size(); before += heights[k++]) {
        blocks.push_back({requests[k] - before, 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() > blocks.back().mean()) {
            const Block last = blocks.back();
            blocks.pop_back();
            blocks.back().sum += last.sum;
            blocks.back().n += last.n;
        }
    }
    const double slack = std::max(high - low - before, 0.0);
    std::vector<double> places;
    before = 0;
    for (const Block& block : blocks) {
        for (std::size_t k = 0; k < block.n; ++k) {
            places.push_back(low + std::clamp(block.mean() - low, 0.0, slack) + before);
            before += heights[places.size() - 1];
        }
    }
    return places;
}

PlotLegend::PlotLegend(std::span<const PlotLine> lines, std::span<const PlotArea> areas, bool markers, Limits space)
    : markers_(markers) {
    struct Try {
        int size, columns, per_cent;  // share of the width for all columns, in percent
    };
    for (const auto& [size, columns, per_cent] :
         {Try{image::style::text_size, 1, 26}, Try{12, 1, 26}, Try{image::style::small_size, 1, 26},
          Try{image::style::small_size, 2, 40}, Try{10, 2, 40}}) {
        const int column_width = (space.width * per_cent / 100 - (columns - 1) * column_gap) / columns;
        arrange(lines, areas, {size, columns, column_width});
        if (height_ <= space.height) return;
    }
}

int PlotLegend::height_of(const Entry& entry) const {
    return std::max<int>(static_cast<int>(entry.text.size()), 1) * image::style::line_height(size_) + entry_gap;
}

void PlotLegend::align(std::span<const double> ends, int space) {
    if (column_x_.size() != 1) return;
    const double half = image::style::line_height(size_) / 2.0;
    std::vector<double> requests, heights;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
        heights.push_back(height_of(entries_[k]));
        requests.push_back(k < ends.size() && !std::isnan(ends[k]) ? ends[k] - half : space);
    }
    const auto places = places_near(requests, heights, 0, std::max(space, height_));
    for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k].y = static_cast<int>(std::lround(places[k]));
    aligned_ = true;
}

std::optional<double> PlotLegend::sample_of(std::size_t line) const {
    if (!aligned_) return {};
    return entries_[line].y + size_ - image::style::digit_rise(size_) + 0.5;
}

void PlotLegend::arrange(std::span<const PlotLine> lines, std::span<const PlotArea> areas, const Layout& layout) {
    const int size = layout.size, columns = layout.columns;
    entries_.clear();
    size_ = size;
    const int text_width = std::max(layout.column_width - sample_width - sample_gap, 40);
    int total = 0, highest = 0;
    const auto add = [&](const std::string& label, const PlotLine* line, const PlotArea* area) {
        Entry entry{image::wrap_text(label, size, false, text_width), line, area};
        highest = std::max(highest, height_of(entry));
        total += height_of(entry);
        entries_.push_back(std::move(entry));
    };
    for (const auto& line : lines) add(line.label, &line, nullptr);
    for (const auto& area : areas) add(area.label, nullptr, &area);

    // Columns of even height: the smallest height that holds all entries in order.
    int limit = std::max(total / columns, highest);
    for (;; limit += 2) {
        int column = 0, y = 0;
        height_ = 0;
        for (auto& entry : entries_) {
            const int h = height_of(entry);
            if (y + h > limit && y > 0) {
                ++column;
                y = 0;
            }
            entry.column = column;
            entry.y = y;
            y += h;
            height_ = std::max(height_, y);
        }
        if (column < columns) break;
    }
    column_x_.assign(static_cast<std::size_t>(columns), 0);
    width_ = 0;
    for (int column = 0; column < columns; ++column) {
        const int x = width_ + (column > 0 ? column_gap : 0);
        column_x_[static_cast<std::size_t>(column)] = x;
        for (const auto& entry : entries_) {
            if (entry.column != column) continue;
            for (const auto& text : entry.text) width_ = std::max(width_, x + sample_width + sample_gap + text.width);
        }
    }
}

void PlotLegend::draw(image::Canvas& canvas, int x0, int y0) const {
    for (const auto& entry : entries_) {
        const int x = x0 + column_x_[static_cast<std::size_t>(entry.column)], y = y0 + entry.y;
        int text_y = y;
        for (const auto& text : entry.text) {
            canvas.text(x + sample_width + sample_gap, text_y + size_ - text.baseline, text, image::style::ink);
            text_y += image::style::line_height(size_);
        }
        const double middle = y + size_ - image::style::digit_rise(size_) + 0.5;
        if (entry.line == nullptr) {
            canvas.fill(x, static_cast<int>(middle) - 5, sample_width, 11, entry.area->fill);
            canvas.fill(x, static_cast<int>(middle) - 5, sample_width, 1, entry.area->edge);
            continue;
        }
        Stroke stroke({x, y - 6, sample_width, image::style::line_height(size_) + 12});
        stroke.polyline(std::array<Point, 2>{{{x + 1.5, middle}, {x + sample_width - 1.5, middle}}}, line_thickness,
                        entry.line->dashes);
        if (markers_ || entry.line->marker > 0) {
            draw_marker(stroke, {x + sample_width / 2.0, middle}, entry.line->marker);
        }
        stroke.paint(canvas, entry.line->colour);
    }
}

MarkLabels::MarkLabels(std::vector<Mark> marks, int limit) {
    std::ranges::stable_sort(marks, {}, &Mark::x);
    for (const auto& mark : marks) {
        Placed placed{mark.x, {}};
        const int space = std::max(limit - static_cast<int>(mark.x), 40);
        placed.text = image::wrap_text(mark.label, image::style::small_size, false, space);
        for (const auto& text : placed.text) {
            placed.width = std::max(placed.width, text.width);
            placed.height += text.height;
        }
        placed_.push_back(std::move(placed));
    }
    // From the right, each label clears the tops of all labels whose lines begin under it.
    for (std::size_t i = placed_.size(); i-- > 0;) {
        Placed& one = placed_[i];
        one.rise = 3;
        for (std::size_t k = i + 1; k < placed_.size(); ++k) {
            const Placed& other = placed_[k];
            if (other.x <= one.x + one.width + mark_gap) one.rise = std::max(one.rise, other.rise + other.height + 1);
        }
        height_ = std::max(height_, one.rise + one.height + 2);
    }
}

void MarkLabels::draw(image::Canvas& canvas, int top, int foot) const {
    constexpr std::array<double, 2> dashes{4, 3};
    for (const auto& one : placed_) {
        const int x = static_cast<int>(std::floor(one.x));
        const int label_foot = top - one.rise;
        Stroke stroke({x - 2, label_foot, 5, foot - label_foot});
        stroke.polyline(std::array<Point, 2>{{{x + 0.5, label_foot + 0.5}, {x + 0.5, foot + 1.0}}}, 1, dashes);
        stroke.paint(canvas, image::style::soft_ink);
        int y = label_foot - one.height;
        for (const auto& text : one.text) {
            canvas.text(x, y, text, image::style::ink);
            y += text.height;
        }
    }
}

}  // namespace lostbits::output::plot
