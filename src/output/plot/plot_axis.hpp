// Axes of plots: mapping from values to positions, round values for ticks, and the frame with its grid, ticks and
// titles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"

namespace lostbits::output::plot {

/// Description of an axis, as the caller requests it.
struct AxisSpec {
    enum class Scale { linear, log2, log10 };
    std::string title;
    Scale scale = Scale::linear;
    std::optional<double> low = {}, high = {};  ///< the ends; a missing end follows from the data
    bool shows_zero = false;                    ///< log axis only: 0 is drawn below the low end
    bool has_decimal_ticks = false;             ///< log axis only: ticks are `0.5` and `64`, not `2^-1` and `2^6`
    /// Linear axis only: largest possible value, such as all bits of a format. The axis fits the data below the limit,
    /// and reaches the limit, with a line there, if the data come near.
    std::optional<double> limit = {};
};

/// Axis of fractions of the rays, from 0 to at most 1.
inline const AxisSpec fraction_axis{.title = "share of rays", .low = 0.0, .limit = 1};

/// An axis with known ends.
class AxisRange {
public:
    /// Takes the ends from `axis`. A missing end is the least or greatest of the `values` that the axis can show. A
    /// range without extent is widened about its value, and a linear range that comes near 0 starts at 0. Throws
    /// std::invalid_argument for ends that are not finite, not in order, or not positive on a log scale.
    AxisRange(const AxisSpec& axis, const std::vector<double>& values);

    /// True if `value` can be drawn. Infinities can. NaN cannot, and on a log scale neither can values that are not
    /// positive, except 0 if the axis shows 0.
    [[nodiscard]] bool can_show(double value) const noexcept;

    /// Position of a value: 0 at the low end, 1 at the high end, and outside [0, 1] beyond them (at most 10^3, so that
    /// pixels stay countable). An infinite value lies at its end. Undefined for a value that cannot be drawn.
    [[nodiscard]] double position(double value) const noexcept;

    /// A tick of the axis. A tick without a label is a minor one.
    struct Tick {
        double position;
        std::string label;  ///< `4`, `0.25`, `2^-10`, `10^3`
    };

    /// Round values between the ends, with about `tick_budget` (at least 2) labels.
    [[nodiscard]] std::vector<Tick> ticks(int tick_budget) const;

    /// Position of the largest possible value if the axis reaches it.
    [[nodiscard]] std::optional<double> limit_position() const noexcept;

    [[nodiscard]] const std::string& title() const noexcept { return title_; }
    [[nodiscard]] bool is_log() const noexcept { return scale_ != AxisSpec::Scale::linear; }

private:
    [[nodiscard]] double to_axis_scale(double value) const noexcept;
    [[nodiscard]] double position_on_axis(double scaled_value) const noexcept;
    [[nodiscard]] std::string power_label(double exponent, const std::string& text) const;
    void widen(bool is_low_fixed, bool is_high_fixed);
    [[nodiscard]] double fit_high_end(double highest) const noexcept;
    void label_limit(std::vector<Tick>& ticks, int tick_budget) const;
    [[nodiscard]] std::vector<Tick> exponent_ticks(int tick_budget) const;
    /// Ticks for a log axis with fewer than two powers of its base between the ends.
    [[nodiscard]] std::vector<Tick> short_range_ticks(int tick_budget) const;

    std::string title_;
    AxisSpec::Scale scale_;
    bool shows_zero_, has_decimal_ticks_;
    std::optional<double> limit_;
    double lo_ = 0, hi_ = 1;  // exponents on a log scale
};

/// Rotates a text by 90 degrees counterclockwise, so that it is read from the right.
[[nodiscard]] image::TextBitmap rotate_left(const image::TextBitmap& text);

/// Frame of a plot: positions of values in pixels.
struct PlotFrame {
    int x = 0, y = 0, width = 1, height = 1;  ///< inside the frame
    int pad = 0;                              ///< pixels between the frame and the ends of the axes

    /// Pixel of a position from 0 to 1 along an axis. With a pad, 0 and 1 are the middles of pixels; without a pad,
    /// their outer edges.
    [[nodiscard]] double pixel_x(double position) const noexcept;
    [[nodiscard]] double pixel_y(double position) const noexcept;
};

/// Ticks and titles of two axes, rendered once, because the frame's position depends on their sizes.
class PlotAxes {
public:
    /// Renders the ticks for a frame of about `width` by `height` pixels.
    PlotAxes(const AxisRange& x, const AxisRange& y, int width, int height);

    /// Pixels that ticks, labels and title need to the left of the frame and below it.
    [[nodiscard]] int left_margin() const noexcept { return left_margin_; }
    [[nodiscard]] int bottom_margin() const noexcept { return bottom_margin_; }
    /// Pixels that half a label needs above and to the right of the frame, at the high ends of the axes.
    [[nodiscard]] int top_margin() const noexcept { return top_margin_; }
    [[nodiscard]] int right_margin() const noexcept { return right_margin_; }

    /// Draws light lines at the labelled ticks.
    void draw_grid(image::Canvas& canvas, const PlotFrame& frame) const;

    /// Draws the frame, the ticks outside it, their labels and the titles.
    void draw(image::Canvas& canvas, const PlotFrame& frame) const;

private:
    struct Tick {
        double position;
        image::TextBitmap label;
    };
    static std::vector<Tick> render_ticks(const AxisRange& range, int tick_budget);

    std::vector<Tick> x_ticks_, y_ticks_;
    image::TextBitmap x_title_, y_title_;
    int left_margin_ = 0, bottom_margin_ = 0, top_margin_ = 0, right_margin_ = 0;
};

}  // namespace lostbits::output::plot
