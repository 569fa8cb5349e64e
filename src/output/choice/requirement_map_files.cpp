// The requirement of each pixel as a picture, as rows and as text.
#include "output/choice/choice_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/heatmap.hpp"
#include "output/map/row_names.hpp"
#include "output/pixel/look.hpp"

namespace lostbits::output::choice {

using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;

table::Table<RequirementRow> requirement_table() {
    using R = RequirementRow;
    const auto share_of = [](std::uint64_t R::*count) {
        return [count](const R& r) { return static_cast<double>(r.*count) / static_cast<double>(r.pixels); };
    };
    return {{"form", "form under test; any: any of the forms; none: no form in any format", &R::form},
            {"format", "format of its inputs and answers; for any: the format in which the form computes", &R::format},
            {"time_ns", "ns", "per ray and primitive, median of this run; missing for an emulated format", &R::time_ns},
            {"met", "pixels on which it meets the requirement", &R::met},
            {"met_fraction", "1", "met/pixels", share_of(&R::met)},
            {"required",
             "for a form: pixels on which it is the cheapest that meets the requirement; for a format: pixels on which "
             "it is "
             "the narrowest in which any form does; for none: pixels on which nothing does",
             &R::required},
            {"required_fraction", "1", "required/pixels", share_of(&R::required)}};
}

namespace {

/// Number of choices with a colour of their own. A picture with more would not be readable.
constexpr std::size_t max_colours = 10;

std::string name_of(const Candidate& c) {
    return fmt::format("{} {}", map::short_name(*c.row.form->info), c.row.format.name);
}

using pixel::colour_of;
constexpr Rgb8 colour_of_none = colour_of(Outcome::not_a_number), colour_of_unknown = colour_of(Outcome::unresolved),
               colour_of_others = colour_of(Outcome::agree_hit);

/// The candidates that some pixel requires, most pixels first.
std::vector<std::size_t> choices_by_pixels(const RequirementMap& r) {
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c < r.pixels_cheapest.size(); ++c) {
        if (r.pixels_cheapest[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, std::ranges::greater(), [&r](std::size_t c) { return r.pixels_cheapest[c]; });
    return order;
}

/// Colours of the picture, and its legend.
class Colours {
public:
    Colours(const ChoiceResult& chosen, const RequirementMap& r)
        : choices_(r.pixels_cheapest.size(), colour_of_others) {
        const auto order = choices_by_pixels(r);
        const std::size_t coloured_count = order.size() > max_colours ? max_colours - 1 : order.size();
        std::uint64_t other_pixels = 0;
        for (std::size_t k = 0; k < order.size(); ++k) {
            if (k >= coloured_count) {
                other_pixels += r.pixels_cheapest[order[k]];
                continue;
            }
            choices_[order[k]] = image::distinct_colour(k);
            add("left: " + name_of(chosen.all[order[k]]), choices_[order[k]], r.pixels_cheapest[order[k]], r);
        }
        add(fmt::format("left: {} other choices", order.size() - coloured_count), colour_of_others, other_pixels, r);
        for (std::size_t f = 0; f < r.formats.size(); ++f) {
            formats_.push_back(image::distinct_colour(max_colours + f));
            add("right: " + r.formats[f].name, formats_.back(), r.pixels_narrowest[f], r);
        }
        add("nothing meets the requirement", colour_of_none, r.pixels_none_meets, r);
        add("unresolved", colour_of_unknown, r.pixels_unknown, r);
    }
    [[nodiscard]] Rgb8 choice(int index) const { return colour_at(choices_, index); }
    [[nodiscard]] Rgb8 format(int index) const { return colour_at(formats_, index); }
    [[nodiscard]] const std::vector<LegendEntry>& legend() const { return legend_; }

private:
    static Rgb8 colour_at(const std::vector<Rgb8>& colours, int index) {
        if (index >= 0) return colours[static_cast<std::size_t>(index)];
        return index == RequirementMap::none ? colour_of_none : colour_of_unknown;
    }
    void add(std::string label, Rgb8 colour, std::uint64_t count, const RequirementMap& r) {
        if (count > 0) legend_.push_back({std::move(label), colour, pixel::count_text(count, r.pixels())});
    }
    std::vector<Rgb8> choices_, formats_;
    std::vector<LegendEntry> legend_;
};

std::string percent(std::uint64_t count, const RequirementMap& r) {
    const double percentage = 100 * (static_cast<double>(count) / static_cast<double>(r.pixels()));
    if (count == 0 || count == r.pixels()) return fmt::format("{}%", count == 0 ? 0 : 100);
    return percentage < 0.1 ? fmt::format("{:.1g}%", percentage) : fmt::format("{:.4g}%", std::min(percentage, 99.99));
}

}  // namespace

std::vector<RequirementRow> requirement_rows(const ChoiceResult& chosen, const RequirementMap& r) {
    std::vector<RequirementRow> rows;
    for (const std::size_t c : measure::choice::order_by_price(chosen.all)) {
        const Candidate& candidate = chosen.all[c];
        rows.push_back({candidate.row.form->info->name, candidate.row.format.name, candidate.time.median * 1e9,
                        r.pixels_met[c], r.pixels_cheapest[c], r.pixels()});
    }
    for (std::size_t f = 0; f < r.formats.size(); ++f)
        rows.push_back({"any", r.formats[f].name, {}, r.pixels_any_form_meets[f], r.pixels_narrowest[f], r.pixels()});
    rows.push_back({"none", "", {}, 0, r.pixels_none_meets, r.pixels()});
    return rows;
}

void draw_requirement_map(const std::filesystem::path& path, const ChoiceResult& chosen, const RequirementMap& r) {
    const Colours colours(chosen, r);
    const int gap = std::max(1, r.width / 32);
    const Requirement& requirement = chosen.request.requirement;
    image::HeatmapSpec spec;
    spec.title = fmt::format("What each pixel of {} requires", chosen.request.id());
    spec.subtitle = {
        fmt::format("Required at each pixel: the right decision, and {:g} correct bits of t if the ray hits{}",
                    requirement.bits,
                    requirement.has_tolerance() ? fmt::format(", at most {} off", requirement.tolerance) : ""),
        "left: the cheapest form and format that meets this, by the times of this run",
        "right: the narrowest format in which any of the forms meets this"};
    spec.width = 2 * r.width + gap;
    spec.height = r.height;
    spec.legend = colours.legend();
    image::HeatmapWriter picture(path, spec);
    std::vector<Rgb8> row(static_cast<std::size_t>(spec.width), image::style::page);
    for (int y = 0; y < r.height; ++y) {
        for (int x = 0; x < r.width; ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(r.width) + static_cast<std::size_t>(x);
            row[static_cast<std::size_t>(x)] = colours.choice(r.cheapest[pixel]);
            row[static_cast<std::size_t>(x + r.width + gap)] = colours.format(r.narrowest[pixel]);
        }
        picture.write_rows(row);
    }
    picture.finish(spec.legend);
}

std::string in_words(const ChoiceResult& chosen, const RequirementMap& r) {
    std::string text = "Pixel by pixel, with any of the forms: ";
    for (std::size_t f = 0; f < r.formats.size(); ++f) {
        text += fmt::format("{}{} {} {}", f == 0 ? "" : ", ", percent(r.pixels_narrowest[f], r),
                            f == 0 ? "need no more than" : "need", r.formats[f].name);
    }
    if (r.pixels_none_meets > 0)
        text += fmt::format(", on {} nothing meets the requirement", percent(r.pixels_none_meets, r));
    if (r.pixels_unknown > 0) text += fmt::format(", for {} the truth is not proved", percent(r.pixels_unknown, r));
    text += ".\n";
    const double least_time = r.least_time(chosen.all);
    const auto choice_count = choices_by_pixels(r).size();
    if (chosen.cheapest_index && choice_count > 1) {
        text += fmt::format(
            "The cheapest at each pixel would take {} choices and {:.2f} times the time of this one; switching between "
            "forms cannot gain more.\n",
            choice_count, least_time / chosen.all[*chosen.cheapest_index].time.median);
    }
    return text;
}

}  // namespace lostbits::output::choice
