#include "output/offset/offset_colour.hpp"

#include <fmt/format.h>

#include <cmath>

#include "measure/answer/outcome.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::output::offset {

using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;
using measure::offset::Fault;
using measure::offset::OffsetBand;
using measure::offset::Side;
using measure::offset::StrategyAtPoint;

namespace {

constexpr Rgb8 of(Outcome o) { return image::outcome_colours[static_cast<std::size_t>(o)]; }

constexpr std::array<Rgb8, shown_labels.size()> shown_colours{of(Outcome::agree_miss),   of(Outcome::false_miss),
                                                              of(Outcome::unresolved),   of(Outcome::false_hit),
                                                              of(Outcome::wrong_object), of(Outcome::agree_hit)};
constexpr std::array<const char*, 4> needed_labels{shown_labels[0], "needs no offset", "none is safe", ""};
constexpr std::array<Rgb8, 4> needed_colours{of(Outcome::agree_miss), of(Outcome::agree_hit), of(Outcome::not_a_number),
                                             Rgb8{}};

/// The classes with a pixel, or all of them with the widest count.
template <class Labels, class Colours>
std::vector<LegendEntry> legend(const Labels& labels, const Colours& colours, std::span<const std::uint64_t> counts,
                                std::uint64_t pixels) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < labels.size(); ++k) {
        if (labels[k][0] == '\0' || (!counts.empty() && counts[k] == 0)) continue;
        entries.push_back({labels[k], colours[k],
                           counts.empty() ? fmt::format("{} (>99.9%)", pixels) : map::count_text(counts[k], pixels)});
    }
    return entries;
}

}  // namespace

Shown shown_of(const OffsetBand& band, std::size_t pixel, Side side, std::size_t strategy) {
    if (band.is_point[pixel] == 0) return Shown::no_point;
    const StrategyAtPoint& at = band.at(pixel, side, strategy);
    if (at[Fault::self_hit] > 0) return Shown::self_hit;
    if (at[Fault::lost_occluder] + at[Fault::begins_in_neighbour] + at[Fault::lost_exit] + at[Fault::not_finite] > 0)
        return Shown::lost;
    if (at[Fault::self_hit_by_form] + at[Fault::lost_exit_by_form] > 0) return Shown::by_form;
    return at[Fault::wrong_side] > 0 ? Shown::wrong_side : Shown::safe;
}

Rgb8 colour_of(Shown shown) { return shown_colours[static_cast<std::size_t>(shown)]; }

std::vector<LegendEntry> shown_legend(std::span<const std::uint64_t> counts, std::uint64_t pixels) {
    return legend(shown_labels, shown_colours, counts, pixels);
}
std::vector<LegendEntry> widest_shown_legend(std::uint64_t pixels) { return shown_legend({}, pixels); }

image::ColourScale safe_scale(image::ImageBackend& backend) {
    return image::ColourScale("viridis", backend.ramp("viridis", 256), 0x1p-2, 0x1p14, image::Spacing::log2);
}

Needed needed_of(const OffsetBand& band, std::size_t pixel, Side side) {
    if (band.is_point[pixel] == 0) return Needed::no_point;
    const double safe = band.sides[pixel][static_cast<std::size_t>(side)].safe;
    return safe == 0 ? Needed::nothing : std::isfinite(safe) ? Needed::some : Needed::never;
}

Rgb8 safe_colour(const image::ColourScale& scale, const OffsetBand& band, std::size_t pixel, Side side) {
    const Needed needed = needed_of(band, pixel, side);
    if (needed != Needed::some) return needed_colours[static_cast<std::size_t>(needed)];
    return scale.map(band.sides[pixel][static_cast<std::size_t>(side)].safe / band.ulp[pixel]);
}

std::vector<LegendEntry> needed_legend(std::span<const std::uint64_t> counts, std::uint64_t pixels) {
    return legend(needed_labels, needed_colours, counts, pixels);
}
std::vector<LegendEntry> widest_needed_legend(std::uint64_t pixels) { return needed_legend({}, pixels); }

}  // namespace lostbits::output::offset
