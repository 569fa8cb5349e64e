#include "output/plot/plot_frame.hpp"

#include <algorithm>
#include <cmath>

namespace lostbits::output::plot {

using image::ImageBackend;
using image::TextBitmap;

namespace {

constexpr image::Rgb8 grid_colour{228, 228, 226};
constexpr int tick_length = 5, minor_length = 3, label_gap = 4, title_gap = 6;
constexpr int tick_pitch_x = 76, tick_pitch_y = 44;  // pixels a labelled tick should have

}  // namespace

TextBitmap turned(const TextBitmap& text) {
    TextBitmap out{text.height, text.width, text.width, {}};
    out.coverage.resize(text.coverage.size());
    for (int y = 0; y < text.height; ++y) {
        for (int x = 0; x < text.width; ++x) {
            out.coverage[static_cast<std::size_t>((text.width - 1 - x) * text.height + y)] =
                text.coverage[static_cast<std::size_t>(y * text.width + x)];
        }
    }
    return out;
}

double PlotFrame::across(double position) const noexcept {
    return pad > 0 ? x + pad + 0.5 + position * (width - 2 * pad - 1) : x + position * width;
}

double PlotFrame::up(double position) const noexcept {
    return pad > 0 ? y + pad + 0.5 + (1 - position) * (height - 2 * pad - 1) : y + (1 - position) * height;
}

std::vector<PlotAxes::Tick> PlotAxes::render(ImageBackend& backend, const AxisRange& range, int most) {
    std::vector<Tick> out;
    for (const auto& [position, label] : range.ticks(most)) {
        out.push_back({position, label.empty() ? TextBitmap{} : backend.render_text(label, image::style::text_size)});
    }
    return out;
}

PlotAxes::PlotAxes(ImageBackend& backend, const AxisRange& x, const AxisRange& y, int width, int height)
    : x_ticks_(render(backend, x, width / tick_pitch_x)), y_ticks_(render(backend, y, height / tick_pitch_y)) {
    int widest = 0, highest = 0;
    for (const auto& tick : y_ticks_) {
        widest = std::max(widest, tick.label.width);
        above_ = std::max(above_, tick.label.height / 2 + 2);
    }
    for (const auto& tick : x_ticks_) {
        highest = std::max(highest, tick.label.height);
        right_ = std::max(right_, tick.label.width / 2 + 2);
    }
    left_ = std::max(1 + tick_length + label_gap + widest, right_);
    below_ = 1 + tick_length + label_gap + highest;
    if (!x.title().empty()) {
        x_title_ = image::fit_text(backend, x.title(), image::style::text_size, false, width);
        below_ += title_gap + x_title_.height;
    }
    if (!y.title().empty()) {
        y_title_ = turned(image::fit_text(backend, y.title(), image::style::text_size, false, height));
        left_ += title_gap + y_title_.width;
    }
}

void PlotAxes::draw_grid(image::Canvas& canvas, const PlotFrame& frame) const {
    for (const auto& tick : x_ticks_) {
        const int x = static_cast<int>(std::floor(frame.across(tick.position)));
        if (tick.label.width > 0) canvas.fill(x, frame.y, 1, frame.height, grid_colour);
    }
    for (const auto& tick : y_ticks_) {
        const int y = static_cast<int>(std::floor(frame.up(tick.position)));
        if (tick.label.width > 0) canvas.fill(frame.x, y, frame.width, 1, grid_colour);
    }
}

void PlotAxes::draw(image::Canvas& canvas, const PlotFrame& frame) const {
    canvas.frame(frame.x, frame.y, frame.width, frame.height, image::style::line);
    const int foot = frame.y + frame.height + 1, label_y = foot + tick_length + label_gap;
    int highest = 0;
    for (const auto& tick : x_ticks_) {
        const int x = static_cast<int>(std::floor(frame.across(tick.position)));
        canvas.fill(x, foot, 1, tick.label.width > 0 ? tick_length : minor_length, image::style::soft_ink);
        canvas.text(x - tick.label.width / 2, label_y, tick.label, image::style::ink);
        highest = std::max(highest, tick.label.height);
    }
    for (const auto& tick : y_ticks_) {
        const int y = static_cast<int>(std::floor(frame.up(tick.position)));
        const int length = tick.label.width > 0 ? tick_length : minor_length;
        canvas.fill(frame.x - 1 - length, y, length, 1, image::style::soft_ink);
        canvas.text(frame.x - 1 - tick_length - label_gap - tick.label.width,
                    y - tick.label.baseline + image::style::digit_rise(image::style::text_size), tick.label,
                    image::style::ink);
    }
    canvas.text(frame.x + (frame.width - x_title_.width) / 2, label_y + highest + title_gap, x_title_,
                image::style::ink);
    canvas.text(frame.x - left_, frame.y + (frame.height - y_title_.height) / 2, y_title_, image::style::ink);
}

}  // namespace lostbits::output::plot
