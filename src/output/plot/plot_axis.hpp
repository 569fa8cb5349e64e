// The axes of plots: from values to places, the round values that are written beside them, and the frame with its grid,
// ticks and titles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/image/canvas.hpp"

namespace lostbits::output::plot {

/// What the caller says about an axis.
struct AxisSpec {
    enum class Scale { linear, log2, log10 };
    std::string title;
    Scale scale = Scale::linear;
    std::optional<double> low, high;  ///< the ends; where one is missing the data gives it
    bool zero = false;                ///< of a log axis: 0 has a place of its own, below its low end
    bool decimals = false;            ///< of a log axis: ticks are `0.5` and `64`, not `2^-1` and `2^6`
};

/// An axis whose ends are known.
class AxisRange {
public:
    /// The ends are those of `axis`, else the least and greatest of `values` that have a place. A range without extent
    /// is widened about its value, and a linear one that comes near 0 starts there. Throws std::invalid_argument for
    /// ends that are not finite, not in order, or not positive on a log scale.
    AxisRange(const AxisSpec& axis, const std::vector<double>& values);

    /// Whether `value` has a place: infinities have, a NaN and what is not positive on a log scale have not, but for a
    /// zero that has a place of its own.
    [[nodiscard]] bool has_place(double value) const noexcept;

    /// 0 at the low end, 1 at the high one, beyond them outside (at most 10^3, so that pixels stay countable); an
    /// infinite value lies at its end. Meaningless without a place.
    [[nodiscard]] double position(double value) const noexcept;

    /// A tick; without a label it is a minor one.
    struct Tick {
        double position;
        std::string label;  ///< `4`, `0.25`, `2^-10`, `10^3`
    };

    /// Round values between the ends, about `most` (at least 2) labelled ones.
    [[nodiscard]] std::vector<Tick> ticks(int most) const;

    [[nodiscard]] const std::string& title() const noexcept { return title_; }
    [[nodiscard]] bool is_log() const noexcept { return scale_ != AxisSpec::Scale::linear; }

private:
    [[nodiscard]] double scaled(double value) const noexcept;
    [[nodiscard]] double place(double s) const noexcept;
    [[nodiscard]] std::string power_label(double exponent, const std::string& text) const;
    void widen(bool low_fixed, bool high_fixed);
    [[nodiscard]] std::vector<Tick> exponent_ticks(int most) const;
    /// Where less than two powers lie between the ends.
    [[nodiscard]] std::vector<Tick> ticks_within_a_step(int most) const;

    std::string title_;
    AxisSpec::Scale scale_;
    bool zero_, decimals_;
    double lo_ = 0, hi_ = 1;  // exponents on a log scale
};

/// A quarter turn against the clock: to be read from the right.
[[nodiscard]] image::TextBitmap turned(const image::TextBitmap& text);

/// Where the frame of a plot is and what its axes mean: a value's place in pixels.
struct PlotFrame {
    int x = 0, y = 0, width = 1, height = 1;  ///< inside the frame
    int pad = 0;                              ///< pixels between the frame and the ends of the axes

    /// The place of 0..1 along an axis. With a pad, 0 and 1 are the middles of pixels; without, their outer edges.
    [[nodiscard]] double across(double position) const noexcept;
    [[nodiscard]] double up(double position) const noexcept;
};

/// The ticks and titles of two axes, rendered once: their room is needed before the frame has a place.
class PlotAxes {
public:
    /// For a frame of about `width` by `height` pixels.
    PlotAxes(const AxisRange& x, const AxisRange& y, int width, int height);

    /// Pixels that ticks, labels and title take outside the frame.
    [[nodiscard]] int left() const noexcept { return left_; }
    [[nodiscard]] int below() const noexcept { return below_; }
    /// Half a label, which may stand out at the high ends.
    [[nodiscard]] int above() const noexcept { return above_; }
    [[nodiscard]] int right() const noexcept { return right_; }

    /// Light lines at the labelled ticks.
    void draw_grid(image::Canvas& canvas, const PlotFrame& frame) const;

    /// The frame, the ticks outside it, their labels and the titles.
    void draw(image::Canvas& canvas, const PlotFrame& frame) const;

private:
    struct Tick {
        double position;
        image::TextBitmap label;
    };
    static std::vector<Tick> render(const AxisRange& range, int most);

    std::vector<Tick> x_ticks_, y_ticks_;
    image::TextBitmap x_title_, y_title_;
    int left_ = 0, below_ = 0, above_ = 0, right_ = 0;
};

}  // namespace lostbits::output::plot
