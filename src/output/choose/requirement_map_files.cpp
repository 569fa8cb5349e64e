// Writes the requirement map (what each pixel requires) as a picture, as rows of a table and as text.
#include "output/choose/choice_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/heatmap.hpp"
#include "output/map/form_names.hpp"
#include "output/pixel/look.hpp"

namespace lostbits::output::choose {

using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;

table::Table<RequirementRow> make_requirement_table() {
    using R = RequirementRow;
    const auto pixel_fraction = [](std::uint64_t R::*count) {
        return [count](const R& r) { return static_cast<double>(r.*count) / static_cast<double>(r.pixels); };
    };
    return {{"form", "form under test; any: any of the forms; none: no form in any format", &R::form},
            {"format", "format of its inputs and answers; for any: the format in which the form computes", &R::format},
            {"time_ns", "ns", "per ray and primitive, median of this run; missing for an emulated format", &R::time_ns},
            {"met", "pixels on which it meets the requirement", &R::met},
            {"met_fraction", "1", "met/pixels", pixel_fraction(&R::met)},
            {"required",
             "for a form: pixels on which it is the cheapest that meets the requirement; for a format: pixels on which "
             "it is the narrowest in which any form does; for none: pixels on which nothing does",
             &R::required},
            {"required_fraction", "1", "required/pixels", pixel_fraction(&R::required)}};
}

namespace {

/// Largest number of candidates with a colour of their own. A picture with more colours would not be readable.
constexpr std::size_t max_colours = 10;

std::string name_of(const Candidate& candidate) {
    return fmt::format("{} {}", map::short_name(*candidate.tested_form.form->info), candidate.tested_form.format.name);
}

using pixel::colour_of;
constexpr Rgb8 colour_of_none = colour_of(Outcome::not_a_number), colour_of_unknown = colour_of(Outcome::unresolved),
               colour_of_others = colour_of(Outcome::agree_hit);

/// Indices of the candidates that some pixel requires. The candidate that most pixels require comes first.
std::vector<std::size_t> required_candidates(const RequirementMap& requirement_map) {
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c < requirement_map.cheapest_pixel_counts.size(); ++c) {
        if (requirement_map.cheapest_pixel_counts[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [&requirement_map](std::size_t c) { return requirement_map.cheapest_pixel_counts[c]; });
    return order;
}

/// Colours of a requirement map, and its legend.
class RequirementColours {
public:
    RequirementColours(const ChoiceResult& result, const RequirementMap& requirement_map)
        : candidate_colours_(requirement_map.cheapest_pixel_counts.size(), colour_of_others) {
        add_candidates(result, requirement_map);
        for (std::size_t f = 0; f < requirement_map.formats.size(); ++f) {
            format_colours_.push_back(image::distinct_colour(max_colours + f));
            add("right: " + requirement_map.formats[f].name, format_colours_.back(),
                requirement_map.narrowest_pixel_counts[f], requirement_map);
        }
        add("nothing meets the requirement", colour_of_none, requirement_map.unmet_pixel_count, requirement_map);
        add("unresolved", colour_of_unknown, requirement_map.unknown_pixel_count, requirement_map);
    }
    [[nodiscard]] Rgb8 candidate_colour(int index) const { return colour_at(candidate_colours_, index); }
    [[nodiscard]] Rgb8 format_colour(int index) const { return colour_at(format_colours_, index); }
    [[nodiscard]] const std::vector<LegendEntry>& legend() const { return legend_; }

private:
    /// Gives colours to the candidates that most pixels require; the others share one.
    void add_candidates(const ChoiceResult& result, const RequirementMap& requirement_map) {
        const auto order = required_candidates(requirement_map);
        const std::size_t coloured_count = order.size() > max_colours ? max_colours - 1 : order.size();
        std::uint64_t other_pixels = 0;
        for (std::size_t k = 0; k < order.size(); ++k) {
            if (k >= coloured_count) {
                other_pixels += requirement_map.cheapest_pixel_counts[order[k]];
                continue;
            }
            candidate_colours_[order[k]] = image::distinct_colour(k);
            add("left: " + name_of(result.candidates[order[k]]), candidate_colours_[order[k]],
                requirement_map.cheapest_pixel_counts[order[k]], requirement_map);
        }
        add(fmt::format("left: {} other choices", order.size() - coloured_count), colour_of_others, other_pixels,
            requirement_map);
    }
    static Rgb8 colour_at(const std::vector<Rgb8>& colours, int index) {
        if (index >= 0) return colours[index];
        return index == RequirementMap::none ? colour_of_none : colour_of_unknown;
    }
    void add(std::string label, Rgb8 colour, std::uint64_t count, const RequirementMap& requirement_map) {
        if (count > 0)
            legend_.push_back({std::move(label), colour, pixel::count_text(count, requirement_map.pixel_count())});
    }
    std::vector<Rgb8> candidate_colours_, format_colours_;
    std::vector<LegendEntry> legend_;
};

std::string percent(std::uint64_t count, const RequirementMap& requirement_map) {
    const double percentage = 100 * (static_cast<double>(count) / static_cast<double>(requirement_map.pixel_count()));
    if (count == 0 || count == requirement_map.pixel_count()) return fmt::format("{}%", count == 0 ? 0 : 100);
    return percentage < 0.1 ? fmt::format("{:.1g}%", percentage) : fmt::format("{:.4g}%", std::min(percentage, 99.99));
}

}  // namespace

std::vector<RequirementRow> make_requirement_rows(const ChoiceResult& result, const RequirementMap& requirement_map) {
    std::vector<RequirementRow> rows;
    for (const std::size_t c : measure::choose::order_by_price(result.candidates)) {
        const Candidate& candidate = result.candidates[c];
        rows.push_back({candidate.tested_form.form->info->name, candidate.tested_form.format.name,
                        candidate.time.median * 1e9, requirement_map.met_pixel_counts[c],
                        requirement_map.cheapest_pixel_counts[c], requirement_map.pixel_count()});
    }
    for (std::size_t f = 0; f < requirement_map.formats.size(); ++f)
        rows.push_back({"any",
                        requirement_map.formats[f].name,
                        {},
                        requirement_map.met_by_any_form_pixel_counts[f],
                        requirement_map.narrowest_pixel_counts[f],
                        requirement_map.pixel_count()});
    rows.push_back({"none", "", {}, 0, requirement_map.unmet_pixel_count, requirement_map.pixel_count()});
    return rows;
}

void draw_requirement_map(const std::filesystem::path& path, const ChoiceResult& result,
                          const RequirementMap& requirement_map) {
    const RequirementColours colours(result, requirement_map);
    const int gap = std::max(1, requirement_map.width / 32);
    const Requirement& requirement = result.request.requirement;

    image::HeatmapSpec spec;
    spec.title = fmt::format("What each pixel of {} requires", result.request.id());
    spec.subtitle = {
        fmt::format("Required at each pixel: the right decision, and {:g} correct bits of t if the ray hits{}",
                    requirement.bits,
                    requirement.has_tolerance() ? fmt::format(", at most {} off", requirement.tolerance) : ""),
        "left: the cheapest form and format that meets this, by the times of this run",
        "right: the narrowest format in which any of the forms meets this"};
    spec.width = 2 * requirement_map.width + gap;
    spec.height = requirement_map.height;
    spec.legend = colours.legend();
    image::HeatmapWriter picture(path, spec);

    // Each row has the left picture, a gap in the colour of the page, and the right picture.
    std::vector<Rgb8> row(static_cast<std::size_t>(spec.width), image::style::background);
    for (int y = 0; y < requirement_map.height; ++y) {
        for (int x = 0; x < requirement_map.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(requirement_map.width) +
                               static_cast<std::size_t>(x);
            row[x] = colours.candidate_colour(requirement_map.cheapest[pixel]);
            row[x + requirement_map.width + gap] = colours.format_colour(requirement_map.narrowest[pixel]);
        }
        picture.write_rows(row);
    }
    picture.finish(spec.legend);
}

std::string requirement_map_text(const ChoiceResult& result, const RequirementMap& requirement_map) {
    std::string text = "Pixel by pixel, with any of the forms: ";
    for (std::size_t f = 0; f < requirement_map.formats.size(); ++f) {
        text += fmt::format("{}{} {} {}", f == 0 ? "" : ", ",
                            percent(requirement_map.narrowest_pixel_counts[f], requirement_map),
                            f == 0 ? "need no more than" : "need", requirement_map.formats[f].name);
    }
    if (requirement_map.unmet_pixel_count > 0)
        text += fmt::format(", on {} nothing meets the requirement",
                            percent(requirement_map.unmet_pixel_count, requirement_map));
    if (requirement_map.unknown_pixel_count > 0)
        text += fmt::format(", for {} the truth is not proved",
                            percent(requirement_map.unknown_pixel_count, requirement_map));
    text += ".\n";

    // The gain of switching between forms.
    const double min_time = requirement_map.min_time(result.candidates);
    const auto candidate_count = required_candidates(requirement_map).size();
    if (result.cheapest_index && candidate_count > 1) {
        text += fmt::format(
            "With the cheapest at each pixel, {} candidates would be used, in {:.2f} times the time of this one. "
            "Switching between forms cannot gain more.\n",
            candidate_count, min_time / result.candidates[*result.cheapest_index].time.median);
    }
    return text;
}

}  // namespace lostbits::output::choose
