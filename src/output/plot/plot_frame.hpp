// What the plots share: text that is turned, and the frame with its grid, ticks and titles.
#pragma once

#include <vector>

#include "output/image/canvas.hpp"
#include "output/plot/plot_axis.hpp"

namespace lostbits::output::plot {

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
    PlotAxes(image::ImageBackend& backend, const AxisRange& x, const AxisRange& y, int width, int height);

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
    static std::vector<Tick> render(image::ImageBackend& backend, const AxisRange& range, int most);

    std::vector<Tick> x_ticks_, y_ticks_;
    image::TextBitmap x_title_, y_title_;
    int left_ = 0, below_ = 0, above_ = 0, right_ = 0;
};

}  // namespace lostbits::output::plot
