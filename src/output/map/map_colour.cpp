// Colour scales of metrics, and colours of pixels.
#include "output/map/map_colour.hpp"

#include <algorithm>
#include <cmath>

#include "output/map/form_names.hpp"
#include "output/pixel/look.hpp"

namespace lostbits::output::map {

using image::ColourScale;
using image::LegendEntry;
using image::Rgb8;

Rgb8 make_paler(Rgb8 c) {
    const auto mix_with_background = [](std::uint8_t x, std::uint8_t background) {
        return static_cast<std::uint8_t>((x + background) / 2);
    };
    return {mix_with_background(c.r, image::style::background.r), mix_with_background(c.g, image::style::background.g),
            mix_with_background(c.b, image::style::background.b)};
}

std::string outcome_in_words(Outcome o) {
    if (o == Outcome::wrong_primitive) return "wrong primitive";
    std::string name = name_in_words(measure::answer::outcome_names[static_cast<std::size_t>(o)]);
    if (name.starts_with("agree ")) name.replace(0, 5, "correct");
    return name;
}

ColourScale metric_scale(const Metric& metric, const FloatFormat& format, const std::optional<BarRange>& range) {
    using measure::metric::Ramp;
    const bool is_magnitude = metric.ramp == Ramp::magnitude;
    const double p = format.precision;
    const double low = is_magnitude && metric.low == 0 ? std::exp2(-(p + 6)) : metric.low;
    const double high = metric.high == 0 ? (is_magnitude ? std::exp2(p) : p) : metric.high;
    const image::Spacing spacing = is_magnitude                          ? image::Spacing::log2
                                   : metric.ramp == Ramp::lost && !range ? image::Spacing::root
                                                                         : image::Spacing::linear;
    return {"viridis", image::image_backend().ramp("viridis", 256), range ? range->lo : low, range ? range->hi : high,
            spacing};
}

namespace {

/// The precision of all rows, in bits; 0 if they differ or there is no row.
int common_precision(std::span<const TestedForm> tested_forms) {
    const int first_precision = tested_forms.empty() ? 0 : tested_forms.front().format.parameters.precision;
    const auto has_first_precision = [first_precision](const TestedForm& tested_form) {
        return tested_form.format.parameters.precision == first_precision;
    };
    return std::ranges::all_of(tested_forms, has_first_precision) ? first_precision : 0;
}

}  // namespace

LostBitsScale::LostBitsScale(std::span<const TestedForm> tested_forms)
    : precision_(common_precision(tested_forms)),
      bar_("viridis", image::image_backend().ramp("viridis", 256), 0, precision_ ? precision_ : 100,
           image::Spacing::root),
      unit_(precision_ ? "lost bits" : "% of the significand lost") {}

Rgb8 LostBitsScale::colour(double bits, const FloatFormat& format) const {
    return bar_.colour_of_value(precision_ ? bits : 100 * bits / format.precision);
}

Rgb8 pixel_colour(const ColourScale& scale, Outcome outcome, double value) {
    if (outcome != Outcome::agree_hit) return image::outcome_colours[static_cast<std::size_t>(outcome)];
    // A correct hit on which the metric is undefined (the form has no exact value there) gets the colour of its
    // outcome.
    return std::isnan(value) ? image::outcome_colours[0] : scale.colour_of_value(std::fabs(value));
}

std::vector<LegendEntry> make_outcome_legend(std::span<const std::uint64_t> counts, std::uint64_t total) {
    std::vector<LegendEntry> entries;
    for (std::size_t o = 1; o < counts.size(); ++o) {
        if (counts[o] == 0) continue;
        entries.push_back({outcome_in_words(static_cast<Outcome>(o)), image::outcome_colours[o],
                           pixel::count_text(counts[o], total)});
    }
    return entries;
}

}  // namespace lostbits::output::map
