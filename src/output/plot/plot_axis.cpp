#include "output/plot/plot_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "output/file/number_text.hpp"

namespace lostbits::output::plot {

using image::TextBitmap;

namespace {

/// A range narrower than this, relative to its larger end, has no round values that a double can tell apart.
constexpr double min_relative_extent = 1e-12;
/// Values below this size count as 0, because steps between subnormal numbers are not round.
constexpr double smallest_nonzero = 1e-300;
/// Fraction of a log axis between 0 and its low end.
constexpr double zero_gap = 0.08;
/// An axis shows at least this fraction of all possible values, so that tiny differences are not magnified.
constexpr double min_shown_fraction = 1.0 / 12;
/// From this fraction on, the axis shows all possible values.
constexpr double show_all_from = 0.75;

/// Multiples of 1, 2 or 5 times 10^k from `lo` to `hi`, at most `tick_budget` + 1 of them.
std::vector<double> round_values(double lo, double hi, int tick_budget) {
    return image::multiples(image::round_step((hi / 2 - lo / 2) / tick_budget * 2), lo, hi);
}

/// Labels with enough digits to tell the ticks apart.
std::vector<std::string> tick_labels(const std::vector<double>& values) {
    double largest = 0, step = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        largest = std::max(largest, std::fabs(values[i]));
        if (i == 1) step = values[1] - values[0];
    }
    const double digits = step > 0 && std::isfinite(step) ? std::ceil(std::log10(largest / step)) + 1 : 0;
    std::vector<std::string> labels;
    for (const double value : values)
        labels.push_back(
            file::short_decimal(value, static_cast<int>(std::clamp<double>(digits, image::tick_digits, 16))));
    return labels;
}

}  // namespace

AxisRange::AxisRange(const AxisSpec& axis, const std::vector<double>& values)
    : title_(axis.title),
      scale_(axis.scale),
      shows_zero_(axis.shows_zero && is_log()),
      has_decimal_ticks_(axis.has_decimal_ticks),
      limit_(is_log() ? std::nullopt : axis.limit) {
    for (const auto& end : {axis.low, axis.high}) {
        if (end && (!std::isfinite(*end) || (is_log() && !(*end > 0)))) {
            throw std::invalid_argument("axis " + axis.title +
                                        ": an end is not finite, or not positive on a log scale");
        }
    }
    if (axis.low && axis.high && !(*axis.low < *axis.high)) {
        throw std::invalid_argument("axis " + axis.title + ": the low end is not below the high end");
    }

    // Find the least and the greatest value that the axis can show.
    double lo = std::numeric_limits<double>::infinity();
    double hi = -lo;
    for (const double value : values) {
        if (!std::isfinite(value) || !can_show(value) || (shows_zero_ && value == 0)) continue;
        lo = std::min(lo, to_axis_scale(value));
        hi = std::max(hi, to_axis_scale(value));
    }
    if (lo > hi) lo = hi = 0;

    // A missing end follows from the data. A linear axis that comes near 0 starts there.
    if (!is_log() && !axis.low && lo > 0 && lo < hi / 4) lo = 0;
    lo_ = axis.low ? to_axis_scale(*axis.low) : lo;
    hi_ = axis.high ? to_axis_scale(*axis.high) : limit_ ? fit_high_end(hi) : hi;
    widen(axis.low.has_value(), axis.high.has_value());
}

double AxisRange::fit_high_end(double highest) const noexcept {
    const double extent = *limit_ - lo_, shown_extent = std::max(highest - lo_, extent * min_shown_fraction);
    return shown_extent >= extent * show_all_from ? *limit_ : lo_ + shown_extent;
}

std::optional<double> AxisRange::limit_position() const noexcept {
    if (!limit_ || *limit_ > hi_) return {};
    return position(*limit_);
}

void AxisRange::widen(bool is_low_fixed, bool is_high_fixed) {
    const double size = std::max(std::fabs(lo_), std::fabs(hi_));
    if (size > smallest_nonzero && hi_ / 2 - lo_ / 2 > size * min_relative_extent) return;
    const double widening = is_log() || size <= smallest_nonzero ? 1 : size / 10;
    constexpr double largest_double = std::numeric_limits<double>::max();
    if (is_high_fixed && !is_low_fixed) {
        lo_ = std::max(hi_ - widening, -largest_double);
    } else if (is_low_fixed && !is_high_fixed) {
        hi_ = std::min(lo_ + widening, largest_double);
    } else {
        lo_ = std::max(lo_ - widening, -largest_double);
        hi_ = std::min(hi_ + widening, largest_double);
    }
}

bool AxisRange::can_show(double value) const noexcept {
    return is_log() ? value > 0 || (shows_zero_ && value == 0) : !std::isnan(value);
}

double AxisRange::to_axis_scale(double value) const noexcept {
    return scale_ == AxisSpec::Scale::linear ? value
           : scale_ == AxisSpec::Scale::log2 ? std::log2(value)
                                             : std::log10(value);
}

double AxisRange::position_on_axis(double scaled_value) const noexcept {
    // Halve first, because hi - lo may overflow.
    const double position = std::clamp((scaled_value / 2 - lo_ / 2) / (hi_ / 2 - lo_ / 2), -1e3, 1e3);
    return shows_zero_ ? zero_gap + (1 - zero_gap) * position : position;
}

double AxisRange::position(double value) const noexcept {
    if (std::isinf(value)) return value > 0 ? 1 : 0;
    if (shows_zero_ && value == 0) return 0;
    return position_on_axis(to_axis_scale(value));
}

std::vector<AxisRange::Tick> AxisRange::short_range_ticks(int tick_budget) const {
    const bool is_log2 = scale_ == AxisSpec::Scale::log2;
    std::vector<Tick> ticks;

    // A short range gets plain numbers: 2.4, not 2^1.26. A label has space for about six digits. In a wider range equal
    // steps would crowd at the upper end.
    const double low = is_log2 ? std::exp2(lo_) : std::pow(10, lo_),
                 high = is_log2 ? std::exp2(hi_) : std::pow(10, hi_);
    if (low >= 1e-3 && high <= 1e5 && high <= 5 * low && high - low > high * min_relative_extent) {
        const auto values = round_values(low, high, tick_budget);
        const auto labels = tick_labels(values);
        for (std::size_t i = 0; i < values.size(); ++i) ticks.push_back({position(values[i]), labels[i]});
        if (ticks.size() >= 2) return ticks;
        ticks.clear();
    }

    const auto exponents = round_values(lo_, hi_, tick_budget);
    const auto labels = tick_labels(exponents);
    for (std::size_t i = 0; i < labels.size(); ++i)
        ticks.push_back({position_on_axis(exponents[i]), power_label(exponents[i], labels[i])});
    return ticks;
}

std::string AxisRange::power_label(double exponent, const std::string& text) const {
    const bool is_log2 = scale_ == AxisSpec::Scale::log2;
    // Six digits: 2^-4 is 0.0625, 2^16 is 65536.
    if (has_decimal_ticks_)
        return file::short_decimal(is_log2 ? std::exp2(exponent) : std::pow(10, exponent), image::tick_digits);
    return (is_log2 ? "2^" : "10^") + text;
}

std::vector<AxisRange::Tick> AxisRange::exponent_ticks(int tick_budget) const {
    const bool is_log2 = scale_ == AxisSpec::Scale::log2;

    // Find the smallest step that the budget allows.
    double step = 1;
    const std::vector<double> steps = is_log2 ? std::vector<double>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}
                                              : std::vector<double>{1, 2, 5, 10, 20, 50, 100, 200, 500};
    for (const double s : steps) {
        step = s;
        if (std::floor(hi_ / s + 1e-9) - std::ceil(lo_ / s - 1e-9) + 1 <= tick_budget) break;
    }

    std::vector<double> exponents;
    for (double k = std::ceil(lo_ / step - 1e-9); k * step <= hi_ + 1e-9; k += 1) exponents.push_back(k * step);
    if (exponents.size() < 2) return short_range_ticks(tick_budget);
    std::vector<Tick> ticks;
    const auto labels = tick_labels(exponents);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        ticks.push_back({position_on_axis(exponents[i]), power_label(exponents[i], labels[i])});
    }

    // Minor ticks between decades, if there are not too many.
    if (is_log2 || step != 1 || hi_ - lo_ > 12) return ticks;
    for (double decade = std::floor(lo_); decade <= hi_; decade += 1) {
        for (int m = 2; m < 10; ++m) {
            const double s = decade + std::log10(m);
            if (s > lo_ && s < hi_) ticks.push_back({position_on_axis(s), {}});
        }
    }
    return ticks;
}

std::vector<AxisRange::Tick> AxisRange::ticks(int tick_budget) const {
    tick_budget = std::max(tick_budget, 2);
    if (is_log()) {
        auto ticks = exponent_ticks(tick_budget);
        if (shows_zero_) ticks.insert(ticks.begin(), {0, "0"});
        return ticks;
    }
    const auto values = round_values(lo_, hi_, tick_budget);
    const auto labels = tick_labels(values);
    std::vector<Tick> ticks;
    for (std::size_t i = 0; i < values.size(); ++i) ticks.push_back({position_on_axis(values[i]), labels[i]});
    label_limit(ticks, tick_budget);
    return ticks;
}

/// Adds a tick for the limit, and removes a round value that is so near that the labels would touch.
void AxisRange::label_limit(std::vector<Tick>& ticks, int tick_budget) const {
    const auto limit_at = limit_position();
    if (!limit_at) return;
    std::erase_if(ticks, [&](const Tick& tick) { return std::fabs(tick.position - *limit_at) < 0.4 / tick_budget; });
    ticks.push_back({*limit_at, file::short_decimal(*limit_, image::tick_digits)});
}

namespace {

constexpr image::Rgb8 grid_colour{228, 228, 226};
constexpr int tick_length = 5, minor_length = 3, label_gap = 4, title_gap = 6;
constexpr int tick_pitch_x = 76, tick_pitch_y = 44;  // pixels per labelled tick

}  // namespace

TextBitmap rotate_left(const TextBitmap& text) {
    TextBitmap result{.width = text.height,
                      .height = text.width,
                      .baseline = text.width,
                      .coverage = {},
                      .runs = text.runs,
                      .is_bold = text.is_bold,
                      .is_rotated = true};
    result.coverage.resize(text.coverage.size());
    for (int y = 0; y < text.height; ++y) {
        for (int x = 0; x < text.width; ++x) {
            result.coverage[(text.width - 1 - x) * text.height + y] = text.coverage[y * text.width + x];
        }
    }
    return result;
}

double PlotFrame::pixel_x(double position) const noexcept {
    return pad > 0 ? x + pad + 0.5 + position * (width - 2 * pad - 1) : x + position * width;
}

double PlotFrame::pixel_y(double position) const noexcept {
    return pad > 0 ? y + pad + 0.5 + (1 - position) * (height - 2 * pad - 1) : y + (1 - position) * height;
}

std::vector<PlotAxes::Tick> PlotAxes::render_ticks(const AxisRange& range, int tick_budget) {
    std::vector<Tick> ticks;
    for (const auto& [position, label] : range.ticks(tick_budget)) {
        ticks.push_back({position, label.empty() ? TextBitmap{}
                                                 : image::image_backend().render_text(label, image::style::text_size)});
    }
    return ticks;
}

PlotAxes::PlotAxes(const AxisRange& x, const AxisRange& y, int width, int height)
    : x_ticks_(render_ticks(x, width / tick_pitch_x)), y_ticks_(render_ticks(y, height / tick_pitch_y)) {
    // Margins for the labels of the ticks.
    int widest_label = 0;
    int tallest_label = 0;
    for (const auto& tick : y_ticks_) {
        widest_label = std::max(widest_label, tick.label.width);
        top_margin_ = std::max(top_margin_, tick.label.height / 2 + 2);
    }
    for (const auto& tick : x_ticks_) {
        tallest_label = std::max(tallest_label, tick.label.height);
        right_margin_ = std::max(right_margin_, tick.label.width / 2 + 2);
    }
    left_margin_ = std::max(1 + tick_length + label_gap + widest_label, right_margin_);
    bottom_margin_ = 1 + tick_length + label_gap + tallest_label;

    // Margins for the titles.
    if (!x.title().empty()) {
        x_title_ = image::fit_text(x.title(), image::style::text_size, image::FontWeight::regular, width);
        bottom_margin_ += title_gap + x_title_.height;
    }
    if (!y.title().empty()) {
        y_title_ = rotate_left(image::fit_text(y.title(), image::style::text_size, image::FontWeight::regular, height));
        left_margin_ += title_gap + y_title_.width;
    }
}

void PlotAxes::draw_grid(image::Canvas& canvas, const PlotFrame& frame) const {
    for (const auto& tick : x_ticks_) {
        const int x = static_cast<int>(std::floor(frame.pixel_x(tick.position)));
        if (tick.label.width > 0) canvas.fill(x, frame.y, 1, frame.height, grid_colour);
    }
    for (const auto& tick : y_ticks_) {
        const int y = static_cast<int>(std::floor(frame.pixel_y(tick.position)));
        if (tick.label.width > 0) canvas.fill(frame.x, y, frame.width, 1, grid_colour);
    }
}

void PlotAxes::draw(image::Canvas& canvas, const PlotFrame& frame) const {
    canvas.frame(frame.x, frame.y, frame.width, frame.height, image::style::line);

    // Ticks and labels.
    const int bottom = frame.y + frame.height + 1;
    const int label_y = bottom + tick_length + label_gap;
    int tallest_label = 0;
    for (const auto& tick : x_ticks_) {
        const int x = static_cast<int>(std::floor(frame.pixel_x(tick.position)));
        canvas.fill(x, bottom, 1, tick.label.width > 0 ? tick_length : minor_length, image::style::soft_ink);
        canvas.text(x - tick.label.width / 2, label_y, tick.label, image::style::ink);
        tallest_label = std::max(tallest_label, tick.label.height);
    }
    for (const auto& tick : y_ticks_) {
        const int y = static_cast<int>(std::floor(frame.pixel_y(tick.position)));
        const int length = tick.label.width > 0 ? tick_length : minor_length;
        canvas.fill(frame.x - 1 - length, y, length, 1, image::style::soft_ink);
        canvas.text(frame.x - 1 - tick_length - label_gap - tick.label.width,
                    y - tick.label.baseline + image::style::digit_rise(image::style::text_size), tick.label,
                    image::style::ink);
    }

    // Titles.
    canvas.text(frame.x + (frame.width - x_title_.width) / 2, label_y + tallest_label + title_gap, x_title_,
                image::style::ink);
    canvas.text(frame.x - left_margin_, frame.y + (frame.height - y_title_.height) / 2, y_title_, image::style::ink);
}

}  // namespace lostbits::output::plot
