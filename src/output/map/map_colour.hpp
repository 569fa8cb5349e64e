// What a pixel of a map looks like: its outcome's fixed colour, or its metric on the ramp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::map {

/// The ends of a colour bar, where someone asks for them: `lo < hi`, and `lo > 0` for a metric drawn by its magnitude.
struct BarRange {
    double lo, hi;
    friend bool operator==(const BarRange&, const BarRange&) = default;
};

/// The scale of a metric in a format. Lost bits run from 0 to all p of the significand, so that a colour is a share of
/// it in every format, scene and sheet, and are spaced by their roots, so that the first bits show: a quarter of the
/// significand is half of the ramp. Magnitudes fit the format as well (`Metric::high`). A `range` is spaced evenly, or
/// by logarithms where the metric is.
image::ColourScale metric_scale(const measure::metric::Metric& metric, const FloatFormat& format,
                                const std::optional<BarRange>& range = {});

/// Colours of lost bits in one picture of rows in any formats: shares of the significand, so that an equal share has an
/// equal colour, and the colours of `metric_scale` in each format. The bar is of bits where all rows have one
/// precision, and of percent where they do not.
class LostBitsScale {
public:
    explicit LostBitsScale(std::span<const measure::evaluate::TestedForm> rows);

    [[nodiscard]] image::Rgb8 colour(double bits, const FloatFormat& format) const;
    [[nodiscard]] const image::ColourScale& bar() const { return bar_; }
    [[nodiscard]] const std::string& unit() const { return unit_; }

private:
    int precision_;  ///< of every row; 0: they differ
    image::ColourScale bar_;
    std::string unit_;
};

/// The colour of one pixel. `value` is the metric's, signed; magnitudes are drawn.
image::Rgb8 pixel_colour(const image::ColourScale& scale, measure::answer::Outcome outcome, double value);

/// Whether the problem explains a loss: there is one, and less than one bit of it lies beyond the envelope.
inline bool inside_envelope(double lost, double excess) { return lost >= 1 && excess < 1; }
/// A colour drawn back: half of it is page. Marks what the problem, not the form, is to blame for.
image::Rgb8 paler(image::Rgb8 colour);
inline constexpr const char* paler_means = "paler: half an ulp in each input would cost as much";

/// `false miss`, `wrong solid`: an outcome in words.
std::string plain_name(measure::answer::Outcome o);

/// The outcomes of a finished row; entries without a pixel are left out.
std::vector<image::LegendEntry> outcome_legend(const measure::evaluate::FormSummary& summary);

}  // namespace lostbits::output::map
