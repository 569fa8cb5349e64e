#include "output/plot/line_plot.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "output/plot/line_plot_parts.hpp"
#include "output/plot/plot_frame.hpp"

namespace lostbits::output::plot {

using image::Canvas;
using image::Point;

namespace {

constexpr int gap = 14;
constexpr int legend_gap = 18;
constexpr int frame_pad = 9;            // half a marker, or the triangle of an infinite value
constexpr int least_right = 120;        // room for the label of a mark at the right edge
constexpr std::size_t few_points = 24;  // a line of at most so many shows each of them
constexpr double marker_pitch = 58;     // pixels between markers on a line of many points
constexpr double triangle_pitch = 11;
constexpr double band_opacity = 0.16;

/// What could not be drawn, for the footnotes.
struct Lacking {
    int off_scale_x = 0, off_scale_y = 0, infinite_x = 0, infinite_y = 0, marks = 0;

    [[nodiscard]] std::vector<std::string> notes() const {
        std::vector<std::string> out;
        const auto add = [&](int count, const char* one, const char* many) {
            if (count > 0) out.push_back(std::to_string(count) + (count == 1 ? one : many));
        };
        if (infinite_y > 0) out.emplace_back("A triangle at the edge stands for an infinite value.");
        add(off_scale_y, " value that is not positive has no place on the log axis and is not drawn.",
            " values that are not positive have no place on the log axis and are not drawn.");
        add(off_scale_x, " point whose parameter is not positive has no place on the log axis and is not drawn.",
            " points whose parameter is not positive have no place on the log axis and are not drawn.");
        add(infinite_x, " point with an infinite parameter is not drawn.",
            " points with an infinite parameter are not drawn.");
        add(marks, " mark lies outside the axis.", " marks lie outside the axis.");
        return out;
    }
};

std::vector<double> values_of(const LinePlotSpec& spec, bool x_axis) {
    std::vector<double> out;
    const auto add = [&](const Series& series) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (!std::isfinite(series.x[i]) || std::isnan(series.y[i])) continue;
            out.push_back(x_axis ? series.x[i] : series.y[i]);
            if (x_axis || series.low.empty()) continue;
            out.push_back(series.low[i]);
            out.push_back(series.high[i]);
        }
    };
    for (const auto& series : spec.series) add(series);
    if (spec.envelope) add(*spec.envelope);
    for (const auto& mark : spec.marks) {
        if (x_axis) out.push_back(mark.x);
    }
    return out;
}

/// The plot with its axes; draws one layer at a time.
class Plot {
public:
    Plot(const LinePlotSpec& spec, const AxisRange& x, const AxisRange& y, const PlotFrame& frame)
        : spec_(spec), x_(x), y_(y), frame_(frame), stroke_(frame.x, frame.y, frame.width, frame.height) {}

    void envelope(Canvas& canvas) {
        const Series& series = *spec_.envelope;
        each_run(series, [&](std::size_t begin, std::size_t end) {
            const auto above = points(series, begin, end, series.y);
            std::vector<Point> below = above;
            for (auto& point : below) point.y = frame_.y + frame_.height;
            stroke_.area(above, below);
        });
        stroke_.paint(canvas, envelope_fill);
    }

    void envelope_line(Canvas& canvas) {
        const Series& series = *spec_.envelope;
        each_run(series, [&](std::size_t begin, std::size_t end) {
            stroke_.polyline(points(series, begin, end, series.y), 1.2);
        });
        stroke_.paint(canvas, envelope_edge);
    }

    void band(Canvas& canvas, const PlotLine& line) {
        const Series& series = *line.series;
        if (series.low.empty()) return;
        each_run(series, [&](std::size_t begin, std::size_t end) {
            // A NaN in the band ends it, though the line goes on.
            for (std::size_t from = begin; from < end; ++from) {
                std::size_t to = from;
                while (to < end && !std::isnan(series.low[to]) && !std::isnan(series.high[to])) ++to;
                stroke_.area(points(series, from, to, series.high), points(series, from, to, series.low));
                from = to;
            }
        });
        stroke_.paint(canvas, line.colour, band_opacity);
    }

    void line(Canvas& canvas, const PlotLine& line, bool markers, std::size_t index) {
        const Series& series = *line.series;
        // Markers of different lines start at different places, so that they do not pile up where lines meet.
        double next = frame_.x + std::fmod(static_cast<double>(index) * 17, marker_pitch), triangle = -1e9;
        each_run(series, [&](std::size_t begin, std::size_t end) {
            const auto run = points(series, begin, end, series.y);
            stroke_.polyline(run, line_thickness, line.dashes);
            for (std::size_t i = 0; i < run.size(); ++i) {
                if (std::isinf(series.y[begin + i])) {
                    if (run[i].x < triangle) continue;
                    const bool up = series.y[begin + i] > 0;
                    draw_edge_triangle(stroke_, {run[i].x, up ? frame_.y + 1.0 : frame_.y + frame_.height - 1.0}, up);
                    triangle = run[i].x + triangle_pitch;
                } else if (markers || run.size() == 1 || (line.marker > 0 && run[i].x >= next)) {
                    draw_marker(stroke_, run[i], line.marker);
                    next = run[i].x + marker_pitch;
                }
            }
        });
        stroke_.paint(canvas, line.colour);
    }

    [[nodiscard]] bool drawable(const Series& series, std::size_t i) const {
        return std::isfinite(series.x[i]) && x_.has_place(series.x[i]) && y_.has_place(series.y[i]);
    }

    void count(const Series& series, Lacking& lacking) const {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (std::isnan(series.x[i]) || std::isnan(series.y[i])) continue;
            lacking.infinite_x += std::isinf(series.x[i]);
            lacking.off_scale_x += std::isfinite(series.x[i]) && !x_.has_place(series.x[i]);
            lacking.off_scale_y += !y_.has_place(series.y[i]);
            lacking.infinite_y += drawable(series, i) && std::isinf(series.y[i]);
        }
    }

private:
    /// Calls `f(begin, end)` for the runs of points that can be drawn.
    template <class F>
    void each_run(const Series& series, F f) {
        for (std::size_t begin = 0; begin < series.x.size(); ++begin) {
            std::size_t end = begin;
            while (end < series.x.size() && drawable(series, end)) ++end;
            if (end > begin) f(begin, end);
            begin = end;
        }
    }

    [[nodiscard]] std::vector<Point> points(const Series& series, std::size_t begin, std::size_t end,
                                            const std::vector<double>& y) const {
        std::vector<Point> out;
        for (std::size_t i = begin; i < end; ++i) {
            // The lower end of a band may leave a log axis.
            const double position = y_.has_place(y[i]) ? y_.position(y[i]) : 0;
            out.push_back({frame_.across(x_.position(series.x[i])), frame_.up(position)});
        }
        return out;
    }

    const LinePlotSpec& spec_;
    const AxisRange &x_, &y_;
    const PlotFrame& frame_;
    image::Stroke stroke_;
};

/// Where a line ends on the page, as it is drawn: 0..1 from the foot, below that when it is nowhere drawn.
double end_of(const PlotLine& line, const AxisRange& x, const AxisRange& y) {
    const Series& series = *line.series;
    for (std::size_t i = series.x.size(); i-- > 0;) {
        if (std::isfinite(series.x[i]) && x.has_place(series.x[i]) && y.has_place(series.y[i])) {
            return std::clamp(y.position(series.y[i]), 0.0, 1.0);
        }
    }
    return -1;
}

}  // namespace

void write_line_plot(image::ImageBackend& backend, const std::filesystem::path& path, const LinePlotSpec& spec) {
    if (spec.width < 400 || spec.height < 200) throw std::invalid_argument(path.string() + ": too small for a plot");
    auto lines = plot_lines(spec.series);
    if (spec.envelope) static_cast<void>(plot_lines({&*spec.envelope, 1}));  // its columns are checked like any
    const AxisRange x(spec.x, values_of(spec, true)), y(spec.y, values_of(spec, false));
    for (auto& line : lines) {
        if (end_of(line, x, y) < 0) line.label += " (no values)";
    }
    std::vector<std::size_t> order(lines.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<PlotLine> sorted = lines;
    std::ranges::stable_sort(sorted, std::ranges::greater{}, [&](const PlotLine& line) { return end_of(line, x, y); });
    const bool markers = std::ranges::all_of(lines, [](const PlotLine& l) { return l.series->x.size() <= few_points; });

    const int content = spec.width - 2 * image::style::margin;
    const Canvas head = image::heading(backend, spec.title, spec.subtitle, content);
    const int top = image::style::margin + head.height() + (head.height() > 0 ? gap : 0);
    const int nominal = std::max(spec.height - top - image::style::margin - 60, 100);
    const PlotLegend legend(backend, sorted, spec.envelope ? &spec.envelope->label : nullptr, markers,
                            {content, nominal});
    const int right =
        std::max(legend.width() > 0 ? legend_gap + legend.width() : 0, spec.marks.empty() ? 0 : least_right);
    const PlotAxes axes(backend, x, y, content - right - 60, nominal);

    PlotFrame frame{image::style::margin + axes.left(), 0, 1, 1, frame_pad};
    frame.width = spec.width - image::style::margin - std::max(right, axes.right()) - 1 - frame.x;
    Lacking lacking;
    std::vector<MarkLabels::Mark> marks;
    for (const auto& mark : spec.marks) {
        const double position = x.has_place(mark.x) && std::isfinite(mark.x) ? x.position(mark.x) : -1;
        if (position >= 0 && position <= 1) {
            marks.push_back({frame.across(position), mark.label});
        } else {
            ++lacking.marks;
        }
    }
    const MarkLabels labels(backend, marks, spec.width - image::style::margin);
    frame.y = top + std::max(labels.height(), axes.above());
    Plot measured(spec, x, y, frame);
    for (const auto& series : spec.series) measured.count(series, lacking);
    if (spec.envelope) measured.count(*spec.envelope, lacking);
    const Canvas notes = image::heading(backend, {}, lacking.notes(), content);
    const int foot = 1 + axes.below() + (notes.height() > 0 ? gap + notes.height() : 0) + image::style::margin;
    frame.height = std::max({spec.height - frame.y - foot, nominal / 2, legend.height()});

    Canvas page(spec.width, frame.y + frame.height + foot);
    page.picture(image::style::margin, image::style::margin, head);
    Plot plot(spec, x, y, frame);
    if (spec.envelope) plot.envelope(page);
    axes.draw_grid(page, frame);
    if (spec.envelope) plot.envelope_line(page);
    for (const auto& line : lines) plot.band(page, line);
    labels.draw(page, frame.y - 1, frame.y + frame.height);
    // Dashes over solid lines: where two agree for a while, both are seen.
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return !lines[i].dashes.empty(); });
    for (const auto i : order) plot.line(page, lines[i], markers, i);
    axes.draw(page, frame);
    if (std::ranges::all_of(lines, [&](const PlotLine& line) { return end_of(line, x, y) < 0; })) {
        const auto text = backend.render_text("no data", image::style::text_size);
        page.text(frame.x + (frame.width - text.width) / 2, frame.y + (frame.height - text.height) / 2, text,
                  image::style::soft_ink);
    }
    legend.draw(page, spec.width - image::style::margin - legend.width(), frame.y);
    page.picture(image::style::margin, page.height() - image::style::margin - notes.height(), notes);

    image::save_png(backend, path, page);
}

}  // namespace lostbits::output::plot
