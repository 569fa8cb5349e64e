#include "output/choice/choice_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/answer/wrong_decision_phrase.hpp"
#include "measure/choice/file_rays.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::choice {

using measure::choice::Growth;
using measure::choice::MarginEnd;

namespace {

double nanoseconds(const Candidate& c) { return c.time.median * 1e9; }

std::string name_of_row(const Candidate& c) {
    const Format inside = measure::choice::computes_in(c.row);
    return fmt::format("{} in {}{}", c.row.form->info->name, c.row.format.name,
                       inside == c.row.format ? "" : fmt::format(", which computes in {}", inside.name));
}

std::string width_of(const Candidate& c) {
    return c.isa == "scalar" ? "one ray at a time" : fmt::format("in registers of {} bits", c.isa);
}

/// True if the times of two differ by no more than they vary: their middle halves overlap.
bool is_as_fast(const Candidate& a, const Candidate& b) {
    return a.time.low_quartile <= b.time.high_quartile && b.time.low_quartile <= a.time.high_quartile;
}

/// Another candidate as fast as the fastest; null for none.
const Candidate* rival_of(const Candidate& fastest, const std::vector<Candidate>& all) {
    const Candidate* rival = nullptr;
    for (const Candidate& c : all) {
        if (&c != &fastest && is_as_fast(c, fastest) && (!rival || c.time.median < rival->time.median)) rival = &c;
    }
    return rival;
}

/// Candidates that were timed one ray at a time while others filled registers.
std::string unequal_widths(const std::vector<Candidate>& all) {
    constexpr std::size_t most = 6;
    std::string names;
    std::string_view wide;
    std::size_t scalar = 0;
    for (const Candidate& c : all) {
        if (c.isa != "scalar") wide = c.isa;
        else if (++scalar <= most) names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of_row(c));
    }
    if (scalar == 0 || wide.empty()) return "";
    if (scalar > most) names += fmt::format(" and {} more", scalar - most);
    return fmt::format(
        "Timed one ray at a time, because they take no more: {}; the others in registers of {} bits. --single times "
        "all "
        "one ray at a time.\n",
        names, wide);
}

std::string kept(const RowQuality& quality, int precision, const Requirement& requirement) {
    return std::isnan(quality.kept_bits)
               ? "no hit to keep bits of"
               : fmt::format("{} of {} bits{}", bits_text_near(quality.kept_bits, requirement), precision,
                             off_text(quality.distance_error, requirement));
}

std::string decisions(const RowQuality& quality) {
    if (quality.wrong == 0) return fmt::format("no wrong decision in {}", scene::toml::counted(quality.rays, "ray"));
    const auto share = quality.wrong_fraction();
    return fmt::format("{} of {} decided wrongly ({}%)", quality.wrong, scene::toml::counted(quality.rays, "ray"),
                       share < 0.001 ? fmt::format("{:.2g}", share * 100) : fmt::format("{:.3g}", share * 100));
}

/// Demands of the form on its caller; empty if there are none.
std::string assumptions(const intersect::Info& info) {
    std::string words;
    const auto add = [&words](const char* more) { words += (words.empty() ? "" : ", ") + std::string(more); };
    if (info.direction == intersect::Direction::unit) add("directions of unit length");
    if (info.roots == intersect::Roots::near_only) add("rays that start outside");
    if (info.touching == intersect::Touching::miss) add("touching is a miss");
    if (info.formats == intersect::Formats::binary32_only) add("inputs and answers in binary32");
    return words;
}

std::string times(double factor) { return fmt::format("{:.2f} times", factor); }

std::string broken_by(const GrowthMargin& margin, const Requirement& requirement, int precision) {
    if (!margin.broken.decides(requirement)) {
        const std::string_view first = measure::answer::wrong_decision_phrase(margin.broken.main_fault.value());
        const std::string rays = scene::toml::counted(margin.broken.rays, "ray");
        if (margin.broken.main_fault_count == margin.broken.wrong)
            return fmt::format("{} ({} of {})", first, margin.broken.wrong, rays);
        return fmt::format("wrong decisions ({} of {}; most often, {} times, {})", margin.broken.wrong, rays,
                           margin.broken.main_fault_count, first);
    }
    return std::isnan(margin.broken.kept_bits) ? "no hit on which form and truth agree"
                                               : "keeping " + kept(margin.broken, precision, requirement);
}

/// `rays`: they come from files, so there is no camera.
const char* growth_phrase(Growth growth, bool rays) {
    switch (growth) {
        case Growth::distance: return rays ? "the rays start" : "the camera is";
        case Growth::radius: return "the primitives are";
        case Growth::offset: return "everything lies";
        case Growth::view: return "the view is";
    }
    return "";
}

std::string so_far(const GrowthMargin& margin, bool rays) {
    switch (margin.growth) {
        case Growth::distance:
            return fmt::format("{:.3g} times farther ({:.4g} units{})", margin.holds, margin.value,
                               rays ? ", the median" : "");
        case Growth::radius: return fmt::format("{:.3g} times larger (radius {:.4g})", margin.holds, margin.value);
        case Growth::offset: return fmt::format("{:.4g} units away from where it is", margin.value);
        case Growth::view: return fmt::format("{:.3g} degrees wide", margin.value);
    }
    return "";
}

std::string margin_text(const GrowthMargin& margin, const ChoiceResult& chosen, int precision) {
    const Requirement& requirement = chosen.request.requirement;
    const bool rays = chosen.request.rays != nullptr;
    if (margin.holds == 0) {
        return fmt::format("has an unknown margin in {}: it already fails on the {} on which that is tried, by {}",
                           measure::choice::growth_names[static_cast<std::size_t>(margin.growth)],
                           rays ? "sample of the rays" : "smaller picture", broken_by(margin, requirement, precision));
    }
    const std::string until = fmt::format("until {} {}", growth_phrase(margin.growth, rays), so_far(margin, rays));
    return "holds " + until +
           margin_end_text(margin, chosen.request.rays,
                           "; beyond that, it fails by " + broken_by(margin, requirement, precision));
}

/// The cheapest strategy that starts the next ray safely.
std::string next_ray(const ChoiceResult& chosen) {
    if (!chosen.offsets || chosen.offsets->points == 0) return "";
    const auto& [outside, both, points, rays] = *chosen.offsets;
    const auto cheapest_of = [](const std::vector<measure::offset::SafeStrategy>& safe) {
        return safe.empty() ? std::string("none")
                            : fmt::format("{} ({})", safe.front().strategy->name,
                                          scene::toml::counted(safe.front().operations, "operation"));
    };
    return fmt::format(
        "  Cheapest strategy for the next ray that is right for all {} from {}: {} if rays only leave the primitive, "
        "{} if rays go into it too.\n",
        scene::toml::counted(rays, "ray"), scene::toml::counted(points, "point"), cheapest_of(outside),
        cheapest_of(both));
}

/// Accuracy of the answers in the files.
std::string own_answers(const ChoiceResult& chosen) {
    if (!chosen.request.rays || !chosen.request.rays->answers) return "";
    const auto& [name, format, quality] = *chosen.request.rays->answers;
    return fmt::format("The answers in the file, {} in {}: {}, {}; {} the requirement. Their time is not known.\n",
                       name, format.name, kept(quality, format.parameters.precision, chosen.request.requirement),
                       decisions(quality),
                       quality.meets(chosen.request.requirement) ? "they meet" : "they do not meet");
}

std::string costs(const ChoiceResult& chosen, const Candidate& c) {
    const auto& all = chosen.all;
    const Requirement& requirement = chosen.request.requirement;
    std::string text;
    const auto fast = *measure::choice::fastest(all), accurate = *measure::choice::most_accurate(all);
    const auto of_other = [&](const Candidate& other) {
        return fmt::format("{} ({:.2f} ns{}; {}, {})", name_of_row(other), nanoseconds(other),
                           other.isa == c.isa ? "" : " " + width_of(other),
                           kept(other.quality, other.row.format.parameters.precision, requirement),
                           decisions(other.quality));
    };
    const Candidate* const rival = &all[fast] == &c           ? rival_of(c, all)
                                   : is_as_fast(c, all[fast]) ? &all[fast]
                                                              : nullptr;
    if (rival)
        text += fmt::format("  It is as fast as {}: their times differ by less than they vary.\n", of_other(*rival));
    else if (&all[fast] == &c) text += "  It is the fastest of all.\n";
    else
        text += fmt::format("  {} the time of the fastest, {}.\n", times(nanoseconds(c) / nanoseconds(all[fast])),
                            of_other(all[fast]));
    if (&all[accurate] == &c) text += "  It is the most accurate of all.\n";
    else
        text += fmt::format("  {} the time of the most accurate, {} ({:.2f} ns; {}).\n",
                            times(nanoseconds(c) / nanoseconds(all[accurate])), name_of_row(all[accurate]),
                            nanoseconds(all[accurate]),
                            kept(all[accurate].quality, all[accurate].row.format.parameters.precision, requirement));
    return text;
}

std::string nothing_meets(const ChoiceResult& chosen) {
    const Candidate& near = chosen.all[*measure::choice::nearest(chosen.all, chosen.request.requirement)];
    const int precision = near.row.format.parameters.precision;
    std::string text = fmt::format("Nothing meets the requirement. The nearest is {}: {}, {}; {:.2f} ns.\n",
                                   name_of_row(near), kept(near.quality, precision, chosen.request.requirement),
                                   decisions(near.quality), nanoseconds(near));
    return chosen.obstacle ? text + obstacle_text(chosen, near) : text;
}

/// Results of repairing the forms that do not meet the requirement.
std::string mended_text(const ChoiceResult& chosen) {
    if (!chosen.repaired) return "";
    if (chosen.repaired->empty())
        return "The repair gave no new form: each form here already meets the requirement, or cannot be repaired to "
               "meet it.\n";
    const Requirement& requirement = chosen.request.requirement;
    std::string text;
    for (const RepairedCandidate& one : *chosen.repaired) {
        const auto found =
            std::ranges::find(chosen.all, one.name, [](const Candidate& c) { return c.row.form->info->name; });
        const int precision = found->row.format.parameters.precision;
        text +=
            fmt::format("{} is {}: {}, {}; {:.2f} ns.\n", one.name, one.how,
                        kept(found->quality, precision, requirement), decisions(found->quality), nanoseconds(*found));
        text += fmt::format("  On rays that the search did not use: {}, {}{}. Its file: {}\n",
                            kept(one.held_out, precision, requirement), decisions(one.held_out),
                            one.held_out.meets(requirement) ? "" : ", which does not meet the requirement", one.file);
    }
    return text;
}

}  // namespace

std::string margin_end_text(const GrowthMargin& margin, const measure::choice::FileRays* rays,
                            const std::string& broken) {
    switch (margin.end) {
        case MarginEnd::fails: return broken;
        case MarginEnd::nothing_hit: return "; beyond that no ray hits anything";
        case MarginEnd::other_scene:
            return fmt::format("; beyond that, the scene rounded to {} is another scene",
                               rays ? rays->format.name : "binary32");
        case MarginEnd::none: break;
    }
    return ", the largest change that was tried";
}

std::string bits_text_near(double kept, const Requirement& requirement) {
    std::string text;
    for (int digits = 1; digits <= 9; ++digits) {
        text = file::kept_text(kept, digits);
        if ((file::number_in(text).value_or(kept) < requirement.bits) == (kept < requirement.bits)) break;
    }
    return text;
}

std::string off_text(double off, const Requirement& requirement) {
    if (!requirement.has_tolerance() || std::isnan(off)) return "";
    std::string text;
    for (int digits = 2; digits <= 17; ++digits) {
        text = fmt::format("{:.{}g}", off, digits);
        if ((file::number_in(text).value_or(off) <= requirement.tolerance) == (off <= requirement.tolerance)) break;
    }
    return ", " + text + " off";
}

std::string in_words(const Requirement& requirement) {
    // All typed digits are shown, because p99.99999 is not every hit.
    const std::string hits =
        requirement.quantile == 1 ? "every hit" : fmt::format("{:.12g} of 100 hits", requirement.quantile * 100);
    const std::string wrong =
        requirement.wrong == 0 ? "no wrong decision"
                               : fmt::format("at most {:.12g}% of the rays decided wrongly", requirement.wrong * 100);
    if (!requirement.has_tolerance()) return fmt::format("{:g} correct bits of {}, {}", requirement.bits, hits, wrong);
    const std::string off = fmt::format("at most {} off", requirement.tolerance);
    if (requirement.bits == 0) return fmt::format("{} {}, {}", hits, off, wrong);
    return fmt::format("{:g} correct bits of {} and {}, {}", requirement.bits, hits, off, wrong);
}

std::string in_words(const ChoiceResult& chosen) {
    std::string text = fmt::format("{}: {}\n", chosen.request.id(), in_words(chosen.request.requirement));
    if (!chosen.meets) {
        text += nothing_meets(chosen);
    } else {
        const Candidate& c = chosen.all[*chosen.meets];
        const int precision = c.row.format.parameters.precision;
        text += fmt::format("The cheapest is {}: {}, {}.\n", name_of_row(c),
                            kept(c.quality, precision, chosen.request.requirement), decisions(c.quality));
        text += fmt::format("  It takes {:.2f} ns per ray and primitive, {}.\n", nanoseconds(c), width_of(c));
        const std::string assumed = assumptions(*c.row.form->info);
        text += assumed.empty() ? "  It assumes nothing about the ray.\n" : fmt::format("  It assumes: {}.\n", assumed);
        text += costs(chosen, c);
        for (const GrowthMargin& margin : chosen.margins)
            text += fmt::format("  It {}.\n", margin_text(margin, chosen, precision));
        text += next_ray(chosen);
    }
    if (chosen.requirement_map) text += in_words(chosen, *chosen.requirement_map);
    text += mended_text(chosen) + own_answers(chosen) + unequal_widths(chosen.all);
    return text + fmt::format("Times are of this run: {} of the {} against {} of its primitives.\n",
                              scene::toml::counted(chosen.timed.rays, "ray"), chosen.request.rays ? "file" : "scene",
                              chosen.timed.primitives);
}

}  // namespace lostbits::output::choice
