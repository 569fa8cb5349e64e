// What a pixel of a map looks like: its outcome's fixed colour, or its metric, on the ramp between the colours of
// outcomes, on the ramp alone, or as categories.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"
#include "output/pixel/look.hpp"

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

class MetricPaint {
public:
    MetricPaint(const measure::metric::Metric& metric, const FloatFormat& format,
                const std::optional<BarRange>& range = {});

    [[nodiscard]] const measure::metric::Metric& metric() const { return *metric_; }
    /// None for categories.
    [[nodiscard]] const std::optional<image::ColourScale>& scale() const { return look_.scale; }
    /// Whether a row has such a picture.
    [[nodiscard]] bool applies_to(const measure::evaluate::TestedForm& row) const;
    /// Whether both are drawn alike, so that they may share a bar.
    [[nodiscard]] bool shares_with(const measure::metric::Metric& other) const;

    [[nodiscard]] image::Rgb8 colour(measure::answer::Outcome outcome, double value) const {
        return look_.colour(pixel(outcome, value));
    }
    /// Its categories: what has a value (several, or one on the ramp); the outcomes, correct hits without a value last,
    /// where `of_mesh` with the names of those of meshes; and whatever else has no value.
    [[nodiscard]] pixel::Look look(bool of_mesh) const;
    /// A pixel of a picture.
    [[nodiscard]] pixel::PixelValue pixel(measure::answer::Outcome outcome, double value) const;
    /// The place of an outcome in the categories.
    [[nodiscard]] std::size_t place_of(measure::answer::Outcome o) const {
        const auto k = static_cast<std::size_t>(o);
        return values_ + (k == 0 ? image::outcome_colours.size() : k) - 1;
    }

    /// What the colours mean, in one line: in this format, or on a sheet of several.
    [[nodiscard]] std::string note(bool several = false) const;
    /// What `p99` in a glance is, for a sheet; empty where no glance has one.
    [[nodiscard]] std::string quantile_note() const;
    /// What a glance at a row should take away, in at most four short lines: wrong decisions, as shares of all pixels,
    /// then how far off the agreed hits are, and how many they are.
    [[nodiscard]] std::string glance(const measure::evaluate::FormSummary& summary, std::size_t m) const;
    /// Whether the row's worst ray is worst by what is drawn: it has the largest error of all.
    [[nodiscard]] bool names_worst() const { return is_of_hits() && look_.scale; }
    /// The same as a sentence, for below a picture.
    [[nodiscard]] std::string caption(const measure::evaluate::FormSummary& summary, std::size_t m) const;
    /// As long as captions of pictures of so many pixels get.
    [[nodiscard]] std::string widest_caption(std::uint64_t pixels) const;

private:
    [[nodiscard]] bool is_of_hits() const { return metric_->over == measure::metric::Over::agreed_hits; }
    /// How far two forms are apart, which exists where both hit.
    [[nodiscard]] bool is_distance() const { return metric_->over == measure::metric::Over::pairs && look_.scale; }
    [[nodiscard]] std::vector<image::LegendEntry> culprit_legend(const pixel::CategoryCounts& all) const;
    [[nodiscard]] std::vector<image::LegendEntry> widest_culprit_legend(std::uint64_t pixels) const;

    const measure::metric::Metric* metric_;
    int precision_;
    bool ranged_;
    pixel::Look look_;
    std::size_t values_ = 0;  ///< categories of what has a value
};

}  // namespace lostbits::output::map
