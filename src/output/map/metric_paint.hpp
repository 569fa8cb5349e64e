// How one metric of a map is drawn in a format: on the ramp between the colours of outcomes, on the ramp alone, or as
// categories.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/map/map_colour.hpp"
#include "output/pixel/look.hpp"

namespace lostbits::output::map {

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
