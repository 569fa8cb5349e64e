#include "output/consistency/accord_colour.hpp"

#include <fmt/format.h>

#include <cmath>

#include "measure/answer/outcome.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::output::consistency {

using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;
using measure::consistency::Accord;
using measure::consistency::accord_names;
using measure::consistency::AccordOfPixels;
using measure::consistency::Check;

namespace {

constexpr Rgb8 of(Outcome o) { return image::outcome_colours[static_cast<std::size_t>(o)]; }

constexpr std::array<Rgb8, accord_names.size()> accord_colours{
    of(Outcome::agree_miss),    // not_asked: neutral, recedes
    of(Outcome::agree_hit),     // agree: slate
    of(Outcome::false_hit),     // first_alone: brown
    of(Outcome::false_miss),    // second_alone: lilac
    of(Outcome::not_a_number),  // other_number: black
    of(Outcome::wrong_object),  // by_inputs: gold
    of(Outcome::unresolved),    // unresolved: violet
};
constexpr std::array<const char*, accord_names.size()> general_labels{"not asked",
                                                                      "both answers are alike",
                                                                      "only the first question is answered with yes",
                                                                      "only the second question is",
                                                                      "alike, but other numbers",
                                                                      "the inputs differ, not the form",
                                                                      "not proved"};

/// The same about one check.
std::string label_of(const Check& check, Accord a) {
    if (a == Accord::first_alone) return fmt::format("yes only for: {}", check.first);
    if (a == Accord::second_alone) return fmt::format("yes only for: {}", check.second);
    return general_labels[static_cast<std::size_t>(a)];
}

}  // namespace

image::ColourScale excess_scale(image::ImageBackend& backend) {
    return image::ColourScale("viridis", backend.ramp("viridis", 256), 0x1p-2, 0x1p14, image::Spacing::log2);
}

bool is_category(const AccordOfPixels& pixels, std::size_t i) {
    return pixels.excess.empty() || std::isnan(pixels.excess[i]);
}

Rgb8 colour_at(const image::ColourScale& scale, const AccordOfPixels& pixels, std::size_t i) {
    if (!is_category(pixels, i)) return scale.map(pixels.excess[i]);
    return accord_colours[static_cast<std::size_t>(pixels.accord[i])];
}

std::vector<LegendEntry> accord_legend(const Check& check, const AccordCounts& counts, std::uint64_t pixels) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < counts.size(); ++k) {
        if (counts[k] > 0)
            entries.push_back(
                {label_of(check, static_cast<Accord>(k)), accord_colours[k], map::count_text(counts[k], pixels)});
    }
    return entries;
}

std::vector<LegendEntry> widest_accord_legend(const Check& check, std::uint64_t pixels) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < accord_names.size(); ++k)
        entries.push_back(
            {label_of(check, static_cast<Accord>(k)), accord_colours[k], fmt::format("{} (>99.9%)", pixels)});
    return entries;
}

std::vector<LegendEntry> sheet_legend(const AccordCounts& counts) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < counts.size(); ++k) {
        if (counts[k] > 0) entries.push_back({general_labels[k], accord_colours[k], ""});
    }
    return entries;
}

}  // namespace lostbits::output::consistency
