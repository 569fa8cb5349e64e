#include "output/plot/scatter_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "output/plot/label_placement.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/plot/plot_axis.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::plot {

using image::Canvas;
using image::Point;
using image::Rgb8;
using image::Stroke;
using image::TextBitmap;

namespace {

constexpr int point_margin = 14;
constexpr double half_marker = 5, hole_radius = 1.7, pareto_front_thickness = 1.6, min_leader_length = 13;
constexpr std::array<Rgb8, ink_colour + 1> point_colours{
    {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {136, 34, 85}, image::style::ink}};
constexpr Rgb8 faint_colour{186, 186, 188}, pareto_front_colour{120, 120, 126};
constexpr std::array<double, 2> dashes{5, 4};

Rgb8 point_colour(std::size_t colour, bool is_faint) {
    return is_faint ? faint_colour : point_colours[colour % point_colours.size()];
}

struct Marker {
    int kind;
    Rgb8 colour;
    bool is_hollow;
};

void paint_marker(Canvas& canvas, Stroke& stroke, Point centre, const Marker& marker) {
    draw_marker(stroke, centre, marker.kind);
    stroke.paint(canvas, marker.colour);
    if (!marker.is_hollow) return;
    stroke.disc(centre, hole_radius);
    stroke.paint(canvas, image::style::background);
}

LabelBox box_around(Point p, double half) { return {p.x - half, p.y - half, 2 * half, 2 * half}; }

LabelBox box_around(Point a, Point b) {
    return {std::min(a.x, b.x) - 1, std::min(a.y, b.y) - 1, std::fabs(a.x - b.x) + 2, std::fabs(a.y - b.y) + 2};
}

/// The entries of a legend side by side, in as many lines as needed.
class ScatterLegend {
public:
    ScatterLegend(const std::vector<ScatterPlotSpec::LegendEntry>& legend, int width) {
        int x = 0, y = 0;
        for (const auto& legend_entry : legend) {
            TextBitmap text = image::image_backend().render_text(legend_entry.label, image::style::text_size);
            const int entry_width = marker_width + text.width + entry_gap;
            if (x > 0 && x + entry_width > width) {
                x = 0;
                y += line_height;
            }
            placed_entries_.push_back({&legend_entry, std::move(text), x, y});
            x += entry_width;
        }
        if (!legend.empty()) height_ = y + line_height;
    }
    [[nodiscard]] int height() const { return height_; }

    void draw(Canvas& canvas, int x, int y) const {
        Stroke stroke({0, 0, canvas.width(), canvas.height()});
        for (const auto& placed : placed_entries_) {
            const Point centre{x + placed.x + marker_width / 2.0, y + placed.y + line_height / 2.0};
            paint_marker(canvas, stroke, centre,
                         {placed.entry->marker, point_colour(placed.entry->colour, placed.entry->is_faint),
                          placed.entry->is_hollow});
            canvas.text(x + placed.x + marker_width, y + placed.y + (line_height - placed.text.height) / 2, placed.text,
                        image::style::ink);
        }
    }

private:
    static constexpr int marker_width = 18, entry_gap = 20, line_height = 20;
    struct PlacedEntry {
        const ScatterPlotSpec::LegendEntry* entry;
        TextBitmap text;
        int x, y;
    };
    std::vector<PlacedEntry> placed_entries_;
    int height_ = 0;
};

bool is_on_axes(const ScatterPoint& p, const AxisRange& x, const AxisRange& y) {
    return !std::isnan(p.x) && !std::isnan(p.y) && x.can_show(p.x) && y.can_show(p.y);
}

/// Draws the inside of the frame.
class ScatterPlotter {
public:
    ScatterPlotter(const ScatterPlotSpec& spec, const AxisRange& x, const AxisRange& y, const PlotFrame& frame)
        : spec_(spec), x_(x), y_(y), frame_(frame), stroke_({frame.x, frame.y, frame.width, frame.height}) {}

    void draw_pareto_front(Canvas& canvas) {
        for (const bool is_solid : {true, false}) {
            for (std::size_t i = 0; i + 1 < spec_.pareto_front.size(); ++i) {
                if (spec_.pareto_front[i].is_solid != is_solid) continue;
                const Point a = point_at(spec_.pareto_front[i].x, spec_.pareto_front[i].y),
                            b = point_at(spec_.pareto_front[i + 1].x, spec_.pareto_front[i + 1].y);
                const std::array<Point, 3> corners{a, {b.x, a.y}, b};
                stroke_.polyline(corners, pareto_front_thickness, is_solid ? std::span<const double>() : dashes);
            }
            stroke_.paint(canvas, pareto_front_colour);
        }
    }

    enum class PointKind { faint, prominent };
    void draw_points(Canvas& canvas, PointKind kind) {
        const bool is_faint = kind == PointKind::faint;
        for (const auto& p : spec_.points) {
            if (p.is_faint != is_faint || !is_on_axes(p, x_, y_)) continue;
            const Rgb8 colour = point_colour(p.colour, p.is_faint);
            const Point centre = point_at(p.x, p.y);
            if (!p.script_id.empty()) canvas.set_mark_data({p.script_id, {centre.x}, {centre.y}});
            if (!is_faint) {
                const std::array<Point, 2> spread{point_at(p.x_low, p.y), point_at(p.x_high, p.y)};
                stroke_.polyline(spread, 1);
                stroke_.paint(canvas, colour);
            }
            paint_marker(canvas, stroke_, centre, {p.marker, colour, p.is_hollow});
            canvas.clear_mark_data();
        }
    }

    void draw_labels(Canvas& canvas) {
        // Labels never cover a point that is not faint. They avoid faint points and the bars.
        std::vector<LabelBox> forbidden, avoided;
        std::vector<LabelRequest> requests;
        std::vector<TextBitmap> texts;
        std::vector<Rgb8> colours;
        for (const auto& p : spec_.points) {
            if (!is_on_axes(p, x_, y_)) continue;
            (p.is_faint ? avoided : forbidden).push_back(box_around(point_at(p.x, p.y), half_marker));
            if (!p.is_faint) avoided.push_back(box_around(point_at(p.x_low, p.y), point_at(p.x_high, p.y)));
            if (p.is_faint || p.label.empty()) continue;

            texts.push_back(image::image_backend().render_text(p.label, image::style::text_size));
            requests.push_back({point_at(p.x, p.y), static_cast<double>(texts.back().width),
                                static_cast<double>(texts.back().height)});
            colours.push_back(point_colour(p.colour, false));
        }

        // They avoid the line of the front, too.
        for (std::size_t i = 0; i + 1 < spec_.pareto_front.size(); ++i) {
            const Point a = point_at(spec_.pareto_front[i].x, spec_.pareto_front[i].y),
                        b = point_at(spec_.pareto_front[i + 1].x, spec_.pareto_front[i + 1].y);
            avoided.push_back(box_around(a, {b.x, a.y}));
            avoided.push_back(box_around({b.x, a.y}, b));
        }

        const LabelBox area{frame_.x + 2.0, frame_.y + 2.0, frame_.width - 4.0, frame_.height - 4.0};
        const auto boxes = place_labels(requests, {area, forbidden, avoided});
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (boxes[i]) draw_label(canvas, requests[i].point, *boxes[i], texts[i], colours[i]);
        }
    }

private:
    [[nodiscard]] Point point_at(double x, double y) const {
        return {frame_.pixel_x(x_.position(x)), frame_.pixel_y(y_.position(y))};
    }

    void draw_label(Canvas& canvas, Point point, const LabelBox& box, const TextBitmap& text, Rgb8 colour) {
        const Point anchor = box.nearest(point);
        if (std::hypot(anchor.x - point.x, anchor.y - point.y) > min_leader_length) {
            const std::array<Point, 2> ends{point, anchor};
            stroke_.polyline(ends, 0.8);
            stroke_.paint(canvas, colour, 0.5);
        }
        canvas.text(static_cast<int>(std::lround(box.x)), static_cast<int>(std::lround(box.y)), text, colour);
    }

    const ScatterPlotSpec& spec_;
    const AxisRange &x_, &y_;
    const PlotFrame& frame_;
    Stroke stroke_;
};

AxisRange axis_range(const ScatterPlotSpec& spec, const AxisSpec& axis, double ScatterPoint::*coordinate) {
    std::vector<double> values;
    for (const auto& p : spec.points) {
        if (std::isnan(p.x) || std::isnan(p.y)) continue;
        values.push_back(p.*coordinate);
    }
    return {axis, values};
}

}  // namespace

Canvas draw_scatter_plot(const ScatterPlotSpec& spec) {
    // Measure the head, the legend, the axes and the footnotes.
    const AxisRange x = axis_range(spec, spec.x, &ScatterPoint::x), y = axis_range(spec, spec.y, &ScatterPoint::y);
    const int content_width = spec.width - 2 * image::style::margin;
    const Canvas head = image::heading(spec.title, spec.subtitle, content_width);
    const ScatterLegend legend(spec.legend, content_width);
    const PlotAxes axes(x, y, content_width - 60, spec.height - 200);
    const auto undrawn_count = static_cast<int>(
        std::ranges::count_if(spec.points, [&](const ScatterPoint& p) { return !is_on_axes(p, x, y); }));
    std::vector<std::string> footnotes;
    if (undrawn_count > 0)
        footnotes.push_back(text::count_with_noun(undrawn_count, "point has no value and is not drawn.",
                                                  "points have no value and are not drawn."));
    const Canvas notes = image::heading({}, footnotes, content_width);

    // Place the frame between them.
    PlotFrame frame{image::style::margin + axes.left_margin(), 0, 1, 1, point_margin};
    frame.width = spec.width - image::style::margin - axes.right_margin() - 1 - frame.x;
    frame.y = image::style::margin + head.height() + image::style::gap + axes.top_margin();
    const int foot =
        1 + axes.bottom_margin() + image::style::gap + legend.height() + notes.height() + image::style::margin;
    frame.height = std::max(spec.height - frame.y - foot, 200);

    // Draw everything from back to front.
    Canvas canvas(spec.width, frame.y + frame.height + foot);
    canvas.draw_canvas(image::style::margin, image::style::margin, head);
    axes.draw_grid(canvas, frame);
    ScatterPlotter plotter(spec, x, y, frame);
    plotter.draw_points(canvas, ScatterPlotter::PointKind::faint);
    plotter.draw_pareto_front(canvas);
    plotter.draw_points(canvas, ScatterPlotter::PointKind::prominent);
    plotter.draw_labels(canvas);
    axes.draw(canvas, frame);
    legend.draw(canvas, image::style::margin, frame.y + frame.height + 1 + axes.bottom_margin() + image::style::gap);
    canvas.draw_canvas(image::style::margin, canvas.height() - image::style::margin - notes.height(), notes);
    return canvas;
}

}  // namespace lostbits::output::plot
