#include "output/plot/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "output/file/number_text.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/plot/plot_axis.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::plot {

using image::Canvas;
using image::Point;

namespace {

constexpr int legend_gap = 34;          // space for the lines that lead to the legend
constexpr int frame_pad = 9;            // half a marker, or the triangle of an infinite value
constexpr int min_right_space = 120;    // space for the label of a mark at the right edge
constexpr std::size_t few_points = 24;  // a line with at most this many points marks each of them
constexpr double marker_pitch = 58;     // pixels between markers on a line of many points
constexpr double triangle_pitch = 11;
constexpr double band_opacity = 0.12;
constexpr std::array<double, 2> limit_dashes{2, 4};

/// Numbers of values, points and marks that could not be drawn, for the footnotes.
struct UndrawnCounts {
    int off_scale_x = 0, off_scale_y = 0, infinite_x = 0, infinite_y = 0, marks = 0;

    [[nodiscard]] std::vector<std::string> notes() const {
        std::vector<std::string> sentences;
        const auto add = [&](int count, const char* singular, const char* plural) {
            if (count > 0) sentences.push_back(text::count_with_noun(count, singular, plural));
        };
        if (infinite_y > 0) sentences.emplace_back("A triangle at the edge marks an infinite value.");
        add(off_scale_y, "value is not positive and is not drawn, because the axis is logarithmic.",
            "values are not positive and are not drawn, because the axis is logarithmic.");
        add(off_scale_x,
            "point has a parameter that is not positive and is not drawn, because the axis is logarithmic.",
            "points have parameters that are not positive and are not drawn, because the axis is logarithmic.");
        add(infinite_x, "point with an infinite parameter is not drawn.",
            "points with an infinite parameter are not drawn.");
        add(marks, "mark lies outside the axis.", "marks lie outside the axis.");
        return sentences;
    }
};

/// Calls `visit(series, i)` for each point with a finite x and a value, also for those of the envelope.
template <class Visit>
void for_each_point(const LinePlotSpec& spec, Visit visit) {
    const auto visit_points = [&visit](const Series& series) {
        for (std::size_t i = 0; i < series.x.size(); ++i)
            if (std::isfinite(series.x[i]) && !std::isnan(series.y[i])) visit(series, i);
    };
    for (const auto& series : spec.series) visit_points(series);
    if (spec.envelope) visit_points(*spec.envelope);
}

/// Values that the x axis should show: those of the points and the marks.
std::vector<double> collect_x_values(const LinePlotSpec& spec) {
    std::vector<double> values;
    for_each_point(spec, [&values](const Series& series, std::size_t i) { values.push_back(series.x[i]); });
    for (const auto& mark : spec.marks) values.push_back(mark.x);
    return values;
}

/// Values that the y axis should show: those of the points and their bands.
std::vector<double> collect_y_values(const LinePlotSpec& spec) {
    std::vector<double> values;
    for_each_point(spec, [&values](const Series& series, std::size_t i) {
        values.push_back(series.y[i]);
        if (series.low.empty()) return;
        values.push_back(series.low[i]);
        values.push_back(series.high[i]);
    });
    return values;
}

/// A line that ends left of this position counts as ending before the right edge of the plot.
constexpr double min_end_position = 0.999;

bool is_on_axis(const AxisRange& x, double value) { return std::isfinite(value) && x.can_show(value); }

/// Index of the last point of a line that is drawn.
std::optional<std::size_t> last_drawn_point(const Series& series, const AxisRange& x, const AxisRange& y) {
    for (std::size_t i = series.x.size(); i-- > 0;) {
        if (is_on_axis(x, series.x[i]) && y.can_show(series.y[i])) return i;
    }
    return {};
}

/// Position of the end of a drawn line, from the left and from the foot of the frame, each from 0 to 1. Nothing if no
/// point of the line is drawn.
std::optional<std::pair<double, double>> line_end(const PlotLine& line, const AxisRange& x, const AxisRange& y) {
    const auto i = last_drawn_point(*line.series, x, y);
    if (!i) return {};
    return std::pair{x.position(line.series->x[*i]), std::clamp(y.position(line.series->y[*i]), 0.0, 1.0)};
}

/// Note for the legend on where a line ends: ` (no values)`, ` (ends at 2^20.3)`. Empty for a line with a value at its
/// last parameter.
std::string ending_note(const PlotLine& line, const LinePlotSpec& spec, const AxisRange& x, const AxisRange& y) {
    const Series& series = *line.series;
    const auto last = last_drawn_point(series, x, y);
    if (!last) return " (no values)";
    const auto undrawn_x = std::span(series.x).subspan(*last + 1);
    if (std::ranges::none_of(undrawn_x, [&](double value) { return is_on_axis(x, value); })) return {};
    const double last_x = series.x[*last];
    return spec.x.scale == AxisSpec::Scale::log2 ? fmt::format(" (ends at 2^{:.3g})", std::log2(last_x))
                                                 : fmt::format(" (ends at {})", file::short_decimal(last_x, 3));
}

std::vector<PlotArea> legend_areas(const LinePlotSpec& spec) {
    std::vector<PlotArea> areas;
    if (spec.envelope) areas.push_back({spec.envelope->label, envelope_fill, envelope_edge});
    for (const PlotShade& shade : spec.shades) areas.push_back({shade.label, shade_fill, shade_fill});
    return areas;
}

/// Draws the inside of the frame. Each function draws one layer.
class LinePlotter {
public:
    LinePlotter(const LinePlotSpec& spec, const AxisRange& x, const AxisRange& y, const PlotFrame& frame)
        : spec_(spec), x_(x), y_(y), frame_(frame), stroke_({frame.x, frame.y, frame.width, frame.height}) {}

    void draw_shades(Canvas& canvas) const {
        for (const PlotShade& shade : spec_.shades) {
            const auto edge = [&](double value) {
                return static_cast<int>(std::lround(frame_.pixel_x(std::clamp(x_.position(value), 0.0, 1.0))));
            };
            if (!x_.can_show(shade.from) || !x_.can_show(shade.to)) continue;
            // A shade that reaches the end of the axis is drawn up to the frame.
            const int left = x_.position(shade.from) <= 0 ? frame_.x : edge(shade.from),
                      right = x_.position(shade.to) >= 1 ? frame_.x + frame_.width : edge(shade.to);
            canvas.fill(left, frame_.y, right - left, frame_.height, shade_fill);
        }
    }

    /// Draws leaders: lines from the ends of the plotted lines to their names in the legend, whose left edge is at
    /// `legend_x`. A plotted line that ends before the right edge of the plot gets no leader, because the leader would
    /// cross other plotted lines. Its name in the legend says where the plotted line ends.
    void draw_leaders(Canvas& canvas, std::span<const PlotLine> lines, const PlotLegend& legend, int legend_x) {
        image::Stroke stroke({frame_.x, frame_.y - 20, legend_x - frame_.x, frame_.height + 40});
        for (std::size_t k = 0; k < lines.size(); ++k) {
            const auto end = line_end(lines[k], x_, y_);
            const auto label_y = legend.sample_y(k);
            if (!end || !label_y || end->first < min_end_position) continue;
            const double y = frame_.pixel_y(end->second), right = frame_.x + frame_.width + 2.0;
            const std::array<Point, 3> path{
                {{right, y}, {legend_x - 6.0, frame_.y + *label_y}, {legend_x - 1.0, frame_.y + *label_y}}};
            stroke.polyline(path, 0.9);
            stroke.paint(canvas, lines[k].colour, 0.5);
        }
    }

    /// Draws a dashed line at the largest possible value.
    void draw_limit(Canvas& canvas) {
        const auto position = y_.limit_position();
        if (!position) return;
        const double y = frame_.pixel_y(*position);
        const std::array<Point, 2> ends{{{frame_.x + 0.0, y}, {frame_.x + frame_.width + 0.0, y}}};
        stroke_.polyline(ends, 1.2, limit_dashes);
        stroke_.paint(canvas, image::style::soft_ink);
    }

    void draw_envelope(Canvas& canvas) {
        const Series& series = *spec_.envelope;
        for_each_run(series, [&](std::size_t begin, std::size_t end) {
            const auto above = points(series, begin, end, series.y);
            std::vector<Point> below = above;
            for (auto& point : below) point.y = frame_.y + frame_.height;
            stroke_.area(above, below);
        });
        stroke_.paint(canvas, envelope_fill);
    }

    void draw_envelope_line(Canvas& canvas) {
        const Series& series = *spec_.envelope;
        for_each_run(series, [&](std::size_t begin, std::size_t end) {
            stroke_.polyline(points(series, begin, end, series.y), 1.2);
        });
        stroke_.paint(canvas, envelope_edge);
    }

    void draw_band(Canvas& canvas, const PlotLine& line) {
        const Series& series = *line.series;
        if (series.low.empty()) return;
        for_each_run(series, [&](std::size_t begin, std::size_t end) {
            // A NaN in the band ends the band, but not the line.
            for (std::size_t valid_begin = begin; valid_begin < end; ++valid_begin) {
                std::size_t valid_end = valid_begin;
                while (valid_end < end && !std::isnan(series.low[valid_end]) && !std::isnan(series.high[valid_end]))
                    ++valid_end;
                stroke_.area(points(series, valid_begin, valid_end, series.high),
                             points(series, valid_begin, valid_end, series.low));
                valid_begin = valid_end;
            }
        });
        stroke_.paint(canvas, line.colour, band_opacity);
    }

    /// Positions of the parameter values on the x axis, for a script.
    [[nodiscard]] image::MarkData step_positions() const {
        image::MarkData data{{}, {}};
        if (spec_.series.empty()) return data;
        for (const double x : spec_.series.front().x)
            data.x.push_back(is_on_axis(x_, x) ? frame_.pixel_x(x_.position(x))
                                               : std::numeric_limits<double>::quiet_NaN());
        data.y = {static_cast<double>(frame_.y), static_cast<double>(frame_.y + frame_.height)};
        return data;
    }

    void draw_line(Canvas& canvas, const PlotLine& line, bool has_markers, std::size_t index) {
        const Series& series = *line.series;
        // Markers of different lines start at different positions, so that they do not pile up where lines meet.
        double next_marker_x = frame_.x + std::fmod(static_cast<double>(index) * 17, marker_pitch),
               next_triangle_x = -1e9;
        for_each_run(series, [&](std::size_t begin, std::size_t end) {
            const auto run = points(series, begin, end, series.y);
            stroke_.polyline(run, line_thickness, line.dashes);

            // Infinite values are triangles at the edge; other points may have markers.
            for (std::size_t i = 0; i < run.size(); ++i) {
                if (std::isinf(series.y[begin + i])) {
                    if (run[i].x < next_triangle_x) continue;
                    const bool points_up = series.y[begin + i] > 0;
                    draw_edge_triangle(stroke_, {run[i].x, points_up ? frame_.y + 1.0 : frame_.y + frame_.height - 1.0},
                                       points_up);
                    next_triangle_x = run[i].x + triangle_pitch;
                } else if (has_markers || run.size() == 1 || (line.marker > 0 && run[i].x >= next_marker_x)) {
                    draw_marker(stroke_, run[i], line.marker);
                    next_marker_x = run[i].x + marker_pitch;
                }
            }
        });
        stroke_.paint(canvas, line.colour);
    }

    [[nodiscard]] bool is_drawable(const Series& series, std::size_t i) const {
        return std::isfinite(series.x[i]) && x_.can_show(series.x[i]) && y_.can_show(series.y[i]);
    }

    void count_undrawn(const Series& series, UndrawnCounts& undrawn) const {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (std::isnan(series.x[i]) || std::isnan(series.y[i])) continue;
            undrawn.infinite_x += std::isinf(series.x[i]);
            undrawn.off_scale_x += std::isfinite(series.x[i]) && !x_.can_show(series.x[i]);
            undrawn.off_scale_y += !y_.can_show(series.y[i]);
            undrawn.infinite_y += is_drawable(series, i) && std::isinf(series.y[i]);
        }
    }

private:
    /// Calls `f(begin, end)` for each run of consecutive points that can be drawn.
    template <class F>
    void for_each_run(const Series& series, F f) {
        for (std::size_t begin = 0; begin < series.x.size(); ++begin) {
            std::size_t end = begin;
            while (end < series.x.size() && is_drawable(series, end)) ++end;
            if (end > begin) f(begin, end);
            begin = end;
        }
    }

    [[nodiscard]] std::vector<Point> points(const Series& series, std::size_t begin, std::size_t end,
                                            const std::vector<double>& y) const {
        std::vector<Point> result;
        for (std::size_t i = begin; i < end; ++i) {
            // The lower end of a band may be below a log axis.
            const double position = y_.can_show(y[i]) ? y_.position(y[i]) : 0;
            result.push_back({frame_.pixel_x(x_.position(series.x[i])), frame_.pixel_y(position)});
        }
        return result;
    }

    const LinePlotSpec& spec_;
    const AxisRange &x_, &y_;
    const PlotFrame& frame_;
    image::Stroke stroke_;
};

/// Page with the title, the subtitle, and a sentence that says why there is no plot.
Canvas canvas_without_plot(const LinePlotSpec& spec) {
    const int content_width = spec.width - 2 * image::style::margin;
    const Canvas head = image::heading(spec.title, spec.subtitle, content_width),
                 sentence = image::heading({}, std::span(&spec.empty_text, 1), content_width);
    Canvas canvas(spec.width, 2 * image::style::margin + head.height() + image::style::gap + sentence.height());
    canvas.draw_canvas(image::style::margin, image::style::margin, head);
    canvas.draw_canvas(image::style::margin, image::style::margin + head.height() + image::style::gap, sentence);
    return canvas;
}

/// The lines sorted by the heights at which they end, the highest first. Lines without a drawn point come last.
std::vector<PlotLine> sort_by_end_height(std::vector<PlotLine> lines, const AxisRange& x, const AxisRange& y) {
    const auto end_height = [&](const PlotLine& line) {
        return line_end(line, x, y).value_or(std::pair{0.0, -1.0}).second;
    };
    std::ranges::stable_sort(lines, std::ranges::greater{}, end_height);
    return lines;
}

/// Marks inside the axis, in pixels. Counts those outside.
std::vector<MarkLabels::Mark> place_marks(const LinePlotSpec& spec, const AxisRange& x, const PlotFrame& frame,
                                          UndrawnCounts& undrawn) {
    std::vector<MarkLabels::Mark> marks;
    for (const auto& mark : spec.marks) {
        const double position = x.can_show(mark.x) && std::isfinite(mark.x) ? x.position(mark.x) : -1;
        if (position >= 0 && position <= 1) {
            marks.push_back({frame.pixel_x(position), mark.label});
        } else {
            ++undrawn.marks;
        }
    }
    return marks;
}

/// Sentences below the plot: what could not be drawn, how many series share lines, and the notes of the caller.
std::vector<std::string> make_footnotes(const LinePlotSpec& spec, std::size_t line_count,
                                        const UndrawnCounts& undrawn) {
    std::vector<std::string> footnotes = undrawn.notes();
    if (line_count < spec.series.size())
        footnotes.push_back(fmt::format("{} for {} series: series with the same values share a line.",
                                        text::count_with_noun(line_count, "line"), spec.series.size()));
    footnotes.insert(footnotes.end(), spec.notes.begin(), spec.notes.end());
    return footnotes;
}

/// Draws dashed lines over solid ones, so that both are visible where they agree.
void draw_lines(Canvas& canvas, LinePlotter& plotter, const std::vector<PlotLine>& lines, bool has_markers) {
    std::vector<std::size_t> order(lines.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return !lines[i].dashes.empty(); });
    for (const auto i : order) {
        if (!lines[i].keys.empty()) canvas.set_mark_data({lines[i].keys, {}});
        plotter.draw_line(canvas, lines[i], has_markers, i);
    }
}

/// Writes the text for a plot without values in the middle of the frame.
void draw_empty_text(Canvas& canvas, const LinePlotSpec& spec, const PlotFrame& frame) {
    const auto text = image::image_backend().render_text(spec.empty_text, image::style::text_size);
    canvas.text(frame.x + (frame.width - text.width) / 2, frame.y + (frame.height - text.height) / 2, text,
                image::style::soft_ink);
}

/// Heights at which the lines end, in pixels below the top of the frame; NaN for a line without a drawn point.
std::vector<double> end_heights(const std::vector<PlotLine>& lines, const AxisRange& x, const AxisRange& y,
                                const PlotFrame& frame) {
    std::vector<double> heights;
    for (const auto& line : lines) {
        const auto end = line_end(line, x, y);
        heights.push_back(end ? frame.pixel_y(end->second) - frame.y : std::numeric_limits<double>::quiet_NaN());
    }
    return heights;
}

}  // namespace

Canvas draw_line_plot(const LinePlotSpec& spec) {
    if (spec.width < 400 || spec.height < 200)
        throw std::invalid_argument("line plot: it needs at least 400 x 200 pixels");
    if (spec.series.empty() && !spec.envelope) return canvas_without_plot(spec);

    // Find the lines and the axes, and note in the legend where lines end.
    auto lines = plot_lines(spec.series);
    if (spec.envelope)
        static_cast<void>(plot_lines({&*spec.envelope, 1}));  // checks its columns like those of any series
    const AxisRange x(spec.x, collect_x_values(spec)), y(spec.y, collect_y_values(spec));
    for (auto& line : lines) line.label += ending_note(line, spec, x, y);
    const std::vector<PlotLine> lines_by_end_height = sort_by_end_height(lines, x, y);
    const bool has_markers =
        std::ranges::all_of(lines, [](const PlotLine& l) { return l.series->x.size() <= few_points; });

    // Measure the head, the legend and the axes.
    const int content_width = spec.width - 2 * image::style::margin;
    const Canvas head = image::heading(spec.title, spec.subtitle, content_width);
    const int top = image::style::margin + head.height() + (head.height() > 0 ? image::style::gap : 0);
    const int nominal_height = std::max(spec.height - top - image::style::margin - 60, 100);
    const auto areas = legend_areas(spec);
    PlotLegend legend(lines_by_end_height, areas, has_markers, {content_width, nominal_height});
    const int right_space =
        std::max(legend.width() > 0 ? legend_gap + legend.width() : 0, spec.marks.empty() ? 0 : min_right_space);
    const PlotAxes axes(x, y, content_width - right_space - 60, nominal_height);

    // Place the left and right edges of the frame. The labels of the marks between them give its top.
    PlotFrame frame{image::style::margin + axes.left_margin(), 0, 1, 1, frame_pad};
    frame.width = spec.width - image::style::margin - std::max(right_space, axes.right_margin()) - 1 - frame.x;
    UndrawnCounts undrawn;
    const MarkLabels labels(place_marks(spec, x, frame, undrawn), spec.width - image::style::margin);
    frame.y = top + std::max(labels.height(), axes.top_margin());

    // The footnotes give its height.
    LinePlotter counting_plotter(spec, x, y, frame);
    for (const auto& series : spec.series) counting_plotter.count_undrawn(series, undrawn);
    if (spec.envelope) counting_plotter.count_undrawn(*spec.envelope, undrawn);
    const Canvas notes = image::heading({}, make_footnotes(spec, lines.size(), undrawn), content_width);
    const int foot =
        1 + axes.bottom_margin() + (notes.height() > 0 ? image::style::gap + notes.height() : 0) + image::style::margin;
    frame.height = std::max({spec.height - frame.y - foot, nominal_height / 2, legend.height()});

    // Draw the head, and the layers of the plot from back to front.
    Canvas canvas(spec.width, frame.y + frame.height + foot);
    canvas.draw_canvas(image::style::margin, image::style::margin, head);
    LinePlotter plotter(spec, x, y, frame);
    plotter.draw_shades(canvas);
    if (spec.envelope) plotter.draw_envelope(canvas);
    axes.draw_grid(canvas, frame);
    plotter.draw_limit(canvas);
    if (spec.envelope) plotter.draw_envelope_line(canvas);
    for (const auto& line : lines) plotter.draw_band(canvas, line);
    labels.draw(canvas, frame.y - 1, frame.y + frame.height);
    draw_lines(canvas, plotter, lines, has_markers);
    canvas.set_mark_data(plotter.step_positions());
    axes.draw(canvas, frame);
    canvas.clear_mark_data();
    if (std::ranges::all_of(lines, [&](const PlotLine& line) { return !line_end(line, x, y); }))
        draw_empty_text(canvas, spec, frame);

    // Draw the legend beside the ends of the lines, and the footnotes.
    legend.align(end_heights(lines_by_end_height, x, y, frame), frame.height);
    const int legend_x = spec.width - image::style::margin - legend.width();
    plotter.draw_leaders(canvas, lines_by_end_height, legend, legend_x);
    legend.draw(canvas, legend_x, frame.y);
    canvas.draw_canvas(image::style::margin, canvas.height() - image::style::margin - notes.height(), notes);
    return canvas;
}

}  // namespace lostbits::output::plot
