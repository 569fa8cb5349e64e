#include "output/picture/render_colour.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/map/map_colour.hpp"

namespace lostbits::output::picture {

using image::ColourScale;
using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;
using measure::picture::Seen;

namespace {

constexpr Rgb8 of(Outcome o) { return image::outcome_colours[static_cast<std::size_t>(o)]; }

constexpr std::array<Rgb8, measure::picture::seen_names.size()> seen_colours{
    of(Outcome::agree_hit), of(Outcome::agree_miss),   of(Outcome::wrong_object), of(Outcome::false_miss),
    of(Outcome::false_hit), of(Outcome::not_a_number), of(Outcome::unresolved)};
constexpr std::array<const char*, measure::picture::seen_names.size()> seen_labels{
    "same sphere",  "background", "another sphere", "sphere lost", "sphere where there is none",
    "not a number", "not proved"};

/// A map of shadow decisions has a colour for each of these, so pixels that show something else share black with NaN.
constexpr const char* seen_otherwise = "sees something else, or NaN";

constexpr Rgb8 lit{255, 255, 125};
constexpr std::array<Rgb8, measure::picture::shadow_names.size()> shadow_colours{
    of(Outcome::agree_miss),   lit,
    of(Outcome::agree_hit),    of(Outcome::false_hit),
    of(Outcome::wrong_object), of(Outcome::false_miss),
    of(Outcome::unresolved)};
constexpr std::array<const char*, measure::picture::shadow_names.size()> shadow_labels{
    "not compared", "both lit", "both in shadow", "false shadow", "own shadow (acne)", "false light", "not proved"};

constexpr std::array<ErrorMapKind, 3> kinds{{
    {"difference of colour", "8-bit steps",
     "colour: largest |channel - true channel| x 255, clamped at both ends of the bar", 0x1p-18, 0x1p8},
    {"angle of the normal", "radians",
     "colour: angle between the computed and the true normal, clamped at both ends of the bar", 0x1p-30, 1},
    {"hit point off the surface", "radii",
     "colour: ||P - G| - r|/r of the computed point P, clamped at both ends of the bar", 0x1p-30, 1},
}};

bool alike(Seen seen) { return seen == Seen::same_sphere || seen == Seen::background; }

std::string widest_count(std::uint64_t pixels) { return fmt::format("{} (>99.9%)", pixels); }

}  // namespace

Rgb8 picture_colour(const measure::picture::Painted& p) {
    if (std::isnan(p.colour.x) || std::isnan(p.colour.y) || std::isnan(p.colour.z)) return nan_colour;
    return {p.byte[0], p.byte[1], p.byte[2]};
}

Rgb8 picture_colour(const measure::picture::TrueColour& c) {
    return c.certain ? Rgb8{c.byte[0], c.byte[1], c.byte[2]} : unproved_colour;
}

const ErrorMapKind& error_map_kind(ErrorMap d) { return kinds[static_cast<std::size_t>(d)]; }

ColourScale error_map_scale(ErrorMap d, image::ImageBackend& backend) {
    const ErrorMapKind& kind = error_map_kind(d);
    return ColourScale("viridis", backend.ramp("viridis", 256), kind.low, kind.high, image::Spacing::log2);
}

Rgb8 error_map_colour(const ColourScale& scale, Seen seen, double value) {
    if (!alike(seen)) return seen_colours[static_cast<std::size_t>(seen)];
    if (seen == Seen::background && !(value > 0)) return seen_colours[static_cast<std::size_t>(seen)];
    return std::isnan(value) ? seen_colours[static_cast<std::size_t>(Seen::not_a_number)] : scale.map(value);
}

Rgb8 shadow_colour(Seen seen, measure::picture::Shadow shadow) {
    if (alike(seen)) return shadow_colours[static_cast<std::size_t>(shadow)];
    return seen_colours[static_cast<std::size_t>(seen == Seen::unresolved ? seen : Seen::not_a_number)];
}

std::vector<LegendEntry> seen_legend(const measure::picture::RenderSummary& s) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 1; k < measure::picture::seen_names.size(); ++k) {
        if (s.seen[k] > 0) entries.push_back({seen_labels[k], seen_colours[k], map::count_text(s.seen[k], s.pixels)});
    }
    return entries;
}

std::vector<LegendEntry> widest_seen_legend(std::uint64_t pixels) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 1; k < measure::picture::seen_names.size(); ++k)
        entries.push_back({seen_labels[k], seen_colours[k], widest_count(pixels)});
    return entries;
}

std::vector<LegendEntry> shadow_legend(const measure::picture::RenderSummary& s) {
    std::vector<LegendEntry> entries;
    const std::uint64_t unproved = s.count(Seen::unresolved),
                        not_alike = s.pixels - s.count(Seen::same_sphere) - s.count(Seen::background);
    const auto add = [&](const char* label, Rgb8 colour, std::uint64_t n) {
        if (n > 0) entries.push_back({label, colour, map::count_text(n, s.pixels)});
    };
    for (std::size_t k = 0; k < measure::picture::shadow_names.size(); ++k) {
        // What is not seen alike is not compared either, and drawn as what it is.
        std::uint64_t n = s.shadow[0][k] + s.shadow[1][k];
        if (k == 0) n -= not_alike;
        if (k == static_cast<std::size_t>(measure::picture::Shadow::unresolved)) n += unproved;
        add(shadow_labels[k], shadow_colours[k], n);
    }
    add(seen_otherwise, of(Outcome::not_a_number), not_alike - unproved);
    return entries;
}

std::vector<LegendEntry> widest_shadow_legend(std::uint64_t pixels) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < measure::picture::shadow_names.size(); ++k)
        entries.push_back({shadow_labels[k], shadow_colours[k], widest_count(pixels)});
    entries.push_back({seen_otherwise, of(Outcome::not_a_number), widest_count(pixels)});
    return entries;
}

}  // namespace lostbits::output::picture
