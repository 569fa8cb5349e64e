// Colour of a pixel of a map: the fixed colour of its outcome, or its metric, either on the ramp or as a category.
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

using measure::answer::Outcome;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

/// Requested ends of a colour bar: `lo < hi`, and `lo > 0` for a metric drawn by its magnitude.
struct BarRange {
    double lo, hi;
    friend bool operator==(const BarRange&, const BarRange&) = default;
};

/// Colour scale of a metric in a format. Lost bits run from 0 to all p bits of the significand, so that a colour is a
/// fraction of the significand in every format, scene and sheet. They are spaced by their square roots, so that the
/// first bits show: a quarter of the significand is half of the ramp. Magnitudes fit the format as well
/// (`Metric::high`). A `range` is spaced evenly, or by logarithms for a metric with a logarithmic scale.
image::ColourScale metric_scale(const Metric& metric, const FloatFormat& format,
                                const std::optional<BarRange>& range = {});

/// Colours of lost bits in one picture with rows in any formats. The colours are fractions of the significand: equal
/// fractions have equal colours, the colours of `metric_scale` in each format. The bar shows bits if all rows have the
/// same precision, otherwise percent.
class LostBitsScale {
public:
    explicit LostBitsScale(std::span<const TestedForm> tested_forms);

    [[nodiscard]] image::Rgb8 colour(double bits, const FloatFormat& format) const;
    [[nodiscard]] const image::ColourScale& bar() const { return bar_; }
    [[nodiscard]] const std::string& unit() const { return unit_; }

private:
    int precision_;  ///< precision of all rows; 0 if the rows differ
    image::ColourScale bar_;
    std::string unit_;
};

/// Colour of one pixel. `value` is the metric with its sign; magnitudes are drawn.
image::Rgb8 pixel_colour(const image::ColourScale& scale, Outcome outcome, double value);

/// True if the problem explains a loss: bits are lost, and less than one bit lies beyond the envelope.
inline bool is_inside_envelope(double lost, double excess) { return lost >= 1 && excess < 1; }
/// Mixes a colour half and half with the colour of the page. The result marks a loss that the problem causes, and not
/// the form.
image::Rgb8 make_paler(image::Rgb8 colour);
inline constexpr const char* paler_colour_meaning = "paler colour: half an ulp in each input would cost as much";

/// An outcome in words: `false miss`, `wrong primitive`.
std::string outcome_in_words(Outcome o);

/// Legend of the outcomes other than `agree_hit`, with the count of each and its fraction of `total`. Outcomes with a
/// count of 0 are left out.
std::vector<image::LegendEntry> make_outcome_legend(std::span<const std::uint64_t> counts, std::uint64_t total);

/// Paints one metric of one format: the colour of each pixel, the legend, and the texts of a picture.
class MetricPaint {
public:
    MetricPaint(const Metric& metric, const FloatFormat& format, const std::optional<BarRange>& range = {});

    [[nodiscard]] const Metric& metric() const { return *metric_; }
    /// The scale; missing for categories.
    [[nodiscard]] const std::optional<image::ColourScale>& scale() const { return look_.scale; }
    /// True if the metric has a picture for this tested form.
    [[nodiscard]] bool applies_to(const TestedForm& tested_form) const;
    /// True if both metrics are drawn alike, so that they may share a colour bar.
    [[nodiscard]] bool shares_bar_with(const Metric& other) const;

    [[nodiscard]] image::Rgb8 colour(Outcome outcome, double value) const {
        return look_.colour(pixel(outcome, value));
    }
    /// Categories of the picture. First come those with a value (several, or one on the ramp), then the outcomes, of
    /// which correct hits without a value are last, then everything else without a value. If `has_mesh`, the outcomes
    /// of meshes have names too.
    [[nodiscard]] pixel::Look look(bool has_mesh) const;
    /// Value of one pixel of the picture.
    [[nodiscard]] pixel::PixelValue pixel(Outcome outcome, double value) const;
    /// Index of an outcome among the categories.
    [[nodiscard]] std::size_t index_of(Outcome outcome) const {
        const auto k = static_cast<std::size_t>(outcome);
        return value_category_count_ + (k == 0 ? image::outcome_colours.size() : k) - 1;
    }

    /// Meaning of the colours in one line, for one format, or for a sheet if `has_several_formats`.
    [[nodiscard]] std::string note(bool has_several_formats = false) const;
    /// Meaning of `p99` in a `short_summary`, for a sheet; empty if no short summary contains a p99.
    [[nodiscard]] std::string quantile_note() const;
    /// Summary of a row in at most four short lines: wrong decisions as fractions of all pixels, then the errors of the
    /// agreed hits, then the number of those hits.
    [[nodiscard]] std::string short_summary(const FormSummary& summary, std::size_t metric_index) const;
    /// True if the worst ray of a row is the one with the largest value of the drawn metric.
    [[nodiscard]] bool names_worst_ray() const { return is_of_hits() && look_.scale; }
    /// The `short_summary` as a sentence, for the caption of a picture.
    [[nodiscard]] std::string caption(const FormSummary& summary, std::size_t metric_index) const;
    /// The longest caption that a picture with this number of pixels can get.
    [[nodiscard]] std::string widest_caption(std::uint64_t pixels) const;

private:
    [[nodiscard]] bool is_of_hits() const { return metric_->domain == measure::metric::MetricDomain::agreed_hits; }
    /// True for a distance between two forms, which exists where both hit.
    [[nodiscard]] bool is_distance() const {
        return metric_->domain == measure::metric::MetricDomain::pairs && look_.scale;
    }
    [[nodiscard]] std::vector<image::LegendEntry> make_culprit_legend(
        const pixel::CategoryCounts& category_counts) const;
    [[nodiscard]] std::vector<image::LegendEntry> make_widest_culprit_legend(std::uint64_t pixels) const;

    /// Short summaries: of culprits, of categories, of numbers that not only hits have, and of errors of hits.
    [[nodiscard]] std::string culprit_summary(const std::vector<std::uint64_t>& counts) const;
    [[nodiscard]] std::string category_summary(const std::vector<std::uint64_t>& counts, std::uint64_t ray_count) const;
    [[nodiscard]] std::string distribution_summary(const measure::metric::Distribution& distribution) const;
    [[nodiscard]] std::string hit_summary(const FormSummary& summary,
                                          const measure::metric::Distribution& distribution) const;
    /// The unit after a number; empty for pure numbers.
    [[nodiscard]] std::string unit_suffix() const;

    const Metric* metric_;
    int precision_;
    bool has_range_;
    pixel::Look look_;
    std::size_t value_category_count_ = 0;  ///< number of categories with a value
};

}  // namespace lostbits::output::map
