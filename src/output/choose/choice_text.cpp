// Sentences about a choice (see `choice_text`).
#include "output/choose/choice_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/answer/wrong_decision_phrase.hpp"
#include "measure/choose/file_rays.hpp"
#include "output/file/number_text.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::choose {

using measure::choose::Growth;
using measure::choose::MarginEnd;

namespace {

double nanoseconds(const Candidate& candidate) { return candidate.time.median * 1e9; }

std::string candidate_name(const Candidate& candidate) {
    const Format inner_format = measure::choose::computing_format(candidate.tested_form);
    return fmt::format(
        "{} in {}{}", candidate.tested_form.form->info->name, candidate.tested_form.format.name,
        inner_format == candidate.tested_form.format ? "" : fmt::format(" with {} inside", inner_format.name));
}

std::string register_phrase(const Candidate& candidate) {
    return candidate.isa == "scalar" ? "one ray at a time" : fmt::format("in registers of {} bits", candidate.isa);
}

/// True if the times of two candidates differ by no more than they vary: the ranges between their quartiles overlap.
bool is_as_fast(const Candidate& a, const Candidate& b) {
    return a.time.low_quartile <= b.time.high_quartile && b.time.low_quartile <= a.time.high_quartile;
}

/// Among the other candidates that are as fast as the fastest one (`is_as_fast`), the fastest; null if no other
/// candidate is as fast.
const Candidate* find_rival(const Candidate& fastest, const std::vector<Candidate>& candidates) {
    const Candidate* rival = nullptr;
    for (const Candidate& candidate : candidates) {
        if (&candidate != &fastest && is_as_fast(candidate, fastest) &&
            (!rival || candidate.time.median < rival->time.median))
            rival = &candidate;
    }
    return rival;
}

/// Sentence that names the candidates timed one ray at a time, if others were timed with several rays in a register.
std::string single_ray_text(const std::vector<Candidate>& candidates) {
    constexpr std::size_t max_names = 6;
    std::string names;
    std::string_view register_bits;
    std::size_t scalar_count = 0;
    for (const Candidate& candidate : candidates) {
        if (candidate.isa != "scalar") register_bits = candidate.isa;
        else if (++scalar_count <= max_names)
            names += fmt::format("{}{}", names.empty() ? "" : ", ", candidate_name(candidate));
    }
    if (scalar_count == 0 || register_bits.empty()) return "";
    if (scalar_count > max_names) names += fmt::format(" and {} more", scalar_count - max_names);
    return fmt::format(
        "Timed one ray at a time, because they take no more: {}; the others in registers of {} bits. --single times "
        "all one ray at a time.\n",
        names, register_bits);
}

std::string kept_bits_phrase(const FormQuality& quality, int precision, const Requirement& requirement) {
    return std::isnan(quality.kept_bits)
               ? "no hit to keep bits of"
               : fmt::format("{} of {} bits{}", kept_bits_text(quality.kept_bits, requirement), precision,
                             distance_error_text(quality.distance_error, requirement));
}

std::string decisions_phrase(const FormQuality& quality) {
    if (quality.wrong_count == 0)
        return fmt::format("no wrong decision in {}", text::count_with_noun(quality.ray_count, "ray"));
    const double fraction = quality.wrong_fraction();
    return fmt::format(
        "{} of {} decided wrongly ({}%)", quality.wrong_count, text::count_with_noun(quality.ray_count, "ray"),
        fraction < 0.001 ? fmt::format("{:.2g}", fraction * 100) : fmt::format("{:.3g}", fraction * 100));
}

/// Assumptions of the form about its rays and inputs; empty if the form assumes nothing.
std::string assumptions_text(const intersect::Info& info) {
    std::string text;
    const auto add = [&text](const char* assumption) { text += (text.empty() ? "" : ", ") + std::string(assumption); };
    if (info.direction == intersect::Direction::unit) add("directions of unit length");
    if (info.roots == intersect::Roots::near_only) add("rays that start outside");
    if (info.touching == intersect::Touching::miss) add("touching is a miss");
    if (info.formats == intersect::Formats::binary32_only) add("inputs and answers in binary32");
    return text;
}

std::string times_phrase(double factor) { return fmt::format("{:.2f} times", factor); }

std::string failure_phrase(const GrowthMargin& margin, const Requirement& requirement, int precision) {
    if (!margin.end_quality.decides_as_required(requirement)) {
        const std::string_view main_fault =
            measure::answer::wrong_decision_phrase(margin.end_quality.main_fault.value());
        const std::string ray_count = text::count_with_noun(margin.end_quality.ray_count, "ray");
        if (margin.end_quality.main_fault_count == margin.end_quality.wrong_count)
            return fmt::format("{} ({} of {})", main_fault, margin.end_quality.wrong_count, ray_count);
        return fmt::format("wrong decisions ({} of {}; most often, {} times, {})", margin.end_quality.wrong_count,
                           ray_count, margin.end_quality.main_fault_count, main_fault);
    }
    return std::isnan(margin.end_quality.kept_bits)
               ? "no hit on which form and truth agree"
               : "keeping " + kept_bits_phrase(margin.end_quality, precision, requirement);
}

/// Beginning of a clause on the largest growth at which the requirement is met. If `rays_from_files`, there is no
/// camera.
const char* growth_phrase(Growth growth, bool rays_from_files) {
    switch (growth) {
        case Growth::distance: return rays_from_files ? "the rays start" : "the camera is";
        case Growth::radius: return "the primitives are";
        case Growth::offset: return "everything lies";
        case Growth::view: return "the view is";
    }
    return "";
}

std::string limit_phrase(const GrowthMargin& margin, bool rays_from_files) {
    switch (margin.growth) {
        case Growth::distance:
            return fmt::format("{:.3g} times farther ({:.4g} units{})", margin.holding_factor, margin.value,
                               rays_from_files ? ", the median" : "");
        case Growth::radius:
            return fmt::format("{:.3g} times larger (radius {:.4g})", margin.holding_factor, margin.value);
        case Growth::offset: return fmt::format("{:.4g} units away from where it is", margin.value);
        case Growth::view: return fmt::format("{:.3g} degrees wide", margin.value);
    }
    return "";
}

std::string margin_text(const GrowthMargin& margin, const ChoiceResult& result, int precision) {
    const Requirement& requirement = result.request.requirement;
    const bool rays_from_files = result.request.rays != nullptr;
    if (margin.holding_factor == 0) {
        return fmt::format("has an unknown margin in {}: it already fails on the {} on which that is tried, by {}",
                           measure::choose::growth_names[static_cast<std::size_t>(margin.growth)],
                           rays_from_files ? "sample of the rays" : "smaller picture",
                           failure_phrase(margin, requirement, precision));
    }
    const std::string until = fmt::format("until {} {}", growth_phrase(margin.growth, rays_from_files),
                                          limit_phrase(margin, rays_from_files));
    return "holds " + until +
           margin_end_text(margin, result.request.rays,
                           "; beyond that, it fails by " + failure_phrase(margin, requirement, precision));
}

/// Sentence on the cheapest strategies that start the next ray safely.
std::string next_ray_text(const ChoiceResult& result) {
    if (!result.offsets || result.offsets->point_count == 0) return "";
    const auto& [outside, both, points, rays] = *result.offsets;
    const auto cheapest_of = [](const std::vector<measure::offset::SafeStrategy>& safe) {
        return safe.empty() ? std::string("none")
                            : fmt::format("{} ({})", safe.front().strategy->name,
                                          text::count_with_noun(safe.front().operation_count, "operation"));
    };
    return fmt::format(
        "  Cheapest strategy for the next ray that is right for all {} from {}: {} if rays only leave the primitive, "
        "{} if rays go into it too.\n",
        text::count_with_noun(rays, "ray"), text::count_with_noun(points, "point"), cheapest_of(outside),
        cheapest_of(both));
}

/// Sentences on the accuracy of the answers in the files; empty if they hold none.
std::string file_answers_text(const ChoiceResult& result) {
    if (!result.request.rays || !result.request.rays->answers) return "";
    const auto& [name, format, quality] = *result.request.rays->answers;
    return fmt::format(
        "The answers in the file, {} in {}: {}, {}; {} the requirement. Their time is not known.\n", name, format.name,
        kept_bits_phrase(quality, format.parameters.precision, result.request.requirement), decisions_phrase(quality),
        quality.meets(result.request.requirement) ? "they meet" : "they do not meet");
}

/// Sentence that compares the time of the cheapest candidate with that of the fastest.
std::string time_sentence(const ChoiceResult& result, const Candidate& cheapest) {
    const auto& candidates = result.candidates;
    const Candidate& fastest = candidates[*measure::choose::find_fastest(candidates)];
    const auto details_of = [&](const Candidate& other) {
        const int precision = other.tested_form.format.parameters.precision;
        return fmt::format("{} ({:.2f} ns{}; {}, {})", candidate_name(other), nanoseconds(other),
                           other.isa == cheapest.isa ? "" : " " + register_phrase(other),
                           kept_bits_phrase(other.quality, precision, result.request.requirement),
                           decisions_phrase(other.quality));
    };

    // Another candidate whose time differs by no more than the noise.
    const Candidate* const rival = &fastest == &cheapest           ? find_rival(cheapest, candidates)
                                   : is_as_fast(cheapest, fastest) ? &fastest
                                                                   : nullptr;
    if (rival)
        return fmt::format("  The timing noise is too large to say whether this or {} is faster.\n",
                           details_of(*rival));
    if (&fastest == &cheapest) return "  It is the fastest of all.\n";
    return fmt::format("  {} the time of the fastest, {}.\n",
                       times_phrase(nanoseconds(cheapest) / nanoseconds(fastest)), details_of(fastest));
}

/// Sentence that compares the cheapest candidate with the most accurate.
std::string accuracy_sentence(const ChoiceResult& result, const Candidate& cheapest) {
    const Candidate& most_accurate = result.candidates[*measure::choose::find_most_accurate(result.candidates)];
    if (&most_accurate == &cheapest) return "  It is the most accurate of all.\n";
    return fmt::format("  {} the time of the most accurate, {} ({:.2f} ns; {}).\n",
                       times_phrase(nanoseconds(cheapest) / nanoseconds(most_accurate)), candidate_name(most_accurate),
                       nanoseconds(most_accurate),
                       kept_bits_phrase(most_accurate.quality, most_accurate.tested_form.format.parameters.precision,
                                        result.request.requirement));
}

/// Sentences on the chosen candidate: its accuracy, time, assumptions and margins, and how the next ray may start.
std::string chosen_candidate_text(const ChoiceResult& result, const Candidate& candidate) {
    const int precision = candidate.tested_form.format.parameters.precision;
    std::string text = fmt::format("The cheapest is {}: {}, {}.\n", candidate_name(candidate),
                                   kept_bits_phrase(candidate.quality, precision, result.request.requirement),
                                   decisions_phrase(candidate.quality));
    text += fmt::format("  It takes {:.2f} ns per ray and primitive, {}.\n", nanoseconds(candidate),
                        register_phrase(candidate));
    const std::string assumptions = assumptions_text(*candidate.tested_form.form->info);
    text +=
        assumptions.empty() ? "  It assumes nothing about the ray.\n" : fmt::format("  It assumes: {}.\n", assumptions);

    text += time_sentence(result, candidate) + accuracy_sentence(result, candidate);
    for (const GrowthMargin& margin : result.margins)
        text += fmt::format("  It {}.\n", margin_text(margin, result, precision));
    return text + next_ray_text(result);
}

std::string nothing_meets_text(const ChoiceResult& result) {
    const Candidate& nearest =
        result.candidates[*measure::choose::find_nearest_candidate(result.candidates, result.request.requirement)];
    const int precision = nearest.tested_form.format.parameters.precision;
    std::string text =
        fmt::format("Nothing meets the requirement. The nearest is {}: {}, {}; {:.2f} ns.\n", candidate_name(nearest),
                    kept_bits_phrase(nearest.quality, precision, result.request.requirement),
                    decisions_phrase(nearest.quality), nanoseconds(nearest));
    return result.obstacle ? text + obstacle_text(result, nearest) : text;
}

/// Sentences on the forms that were repaired to meet the requirement; empty if no repair was requested.
std::string mended_text(const ChoiceResult& result) {
    if (!result.repaired) return "";
    if (result.repaired->empty())
        return "The repair gave no new form: each form here already meets the requirement, or cannot be repaired to "
               "meet it.\n";
    const Requirement& requirement = result.request.requirement;
    std::string text;
    for (const RepairedCandidate& repair : *result.repaired) {
        const auto candidate = std::ranges::find(
            result.candidates, repair.name, [](const Candidate& other) { return other.tested_form.form->info->name; });
        const int precision = candidate->tested_form.format.parameters.precision;

        text += fmt::format("{} is {}: {}, {}; {:.2f} ns.\n", repair.name, repair.method,
                            kept_bits_phrase(candidate->quality, precision, requirement),
                            decisions_phrase(candidate->quality), nanoseconds(*candidate));
        text += fmt::format("  On rays that the search did not use: {}, {}{}. Its file: {}\n",
                            kept_bits_phrase(repair.held_out_quality, precision, requirement),
                            decisions_phrase(repair.held_out_quality),
                            repair.held_out_quality.meets(requirement) ? "" : ", which does not meet the requirement",
                            repair.file);
    }
    return text;
}

}  // namespace

std::string margin_end_text(const GrowthMargin& margin, const measure::choose::FileRays* rays,
                            const std::string& failure_text) {
    switch (margin.end) {
        case MarginEnd::fails: return failure_text;
        case MarginEnd::nothing_hit: return "; beyond that no ray hits anything";
        case MarginEnd::other_scene:
            return fmt::format("; beyond that, the scene rounded to {} is another scene",
                               rays ? rays->format.name : "binary32");
        case MarginEnd::none: break;
    }
    return ", the largest change that was tried";
}

std::string kept_bits_text(double kept_bits, const Requirement& requirement) {
    std::string text;
    for (int digits = 1; digits <= 9; ++digits) {
        text = file::kept_bits_text(kept_bits, digits);
        if ((file::parse_number(text).value_or(kept_bits) < requirement.bits) == (kept_bits < requirement.bits)) break;
    }
    return text;
}

std::string distance_error_text(double distance_error, const Requirement& requirement) {
    if (!requirement.has_tolerance() || std::isnan(distance_error)) return "";
    std::string text;
    for (int digits = 2; digits <= 17; ++digits) {
        text = fmt::format("{:.{}g}", distance_error, digits);
        if ((file::parse_number(text).value_or(distance_error) <= requirement.tolerance) ==
            (distance_error <= requirement.tolerance))
            break;
    }
    return ", " + text + " off";
}

std::string requirement_text(const Requirement& requirement) {
    // All typed digits are shown, because p99.99999 is not every hit.
    const std::string hits =
        requirement.quantile == 1 ? "every hit" : fmt::format("{:.12g} of 100 hits", requirement.quantile * 100);
    const std::string wrong =
        requirement.max_wrong_fraction == 0
            ? "no wrong decision"
            : fmt::format("at most {:.12g}% of the rays decided wrongly", requirement.max_wrong_fraction * 100);
    if (!requirement.has_tolerance()) return fmt::format("{:g} correct bits of {}, {}", requirement.bits, hits, wrong);
    const std::string off = fmt::format("at most {} off", requirement.tolerance);
    if (requirement.bits == 0) return fmt::format("{} {}, {}", hits, off, wrong);
    return fmt::format("{:g} correct bits of {} and {}, {}", requirement.bits, hits, off, wrong);
}

std::string choice_text(const ChoiceResult& result) {
    std::string text = fmt::format("{}: {}\n", result.request.id(), requirement_text(result.request.requirement));
    text += result.cheapest_index ? chosen_candidate_text(result, result.candidates[*result.cheapest_index])
                                  : nothing_meets_text(result);

    if (result.requirement_map) text += requirement_map_text(result, *result.requirement_map);
    text += mended_text(result) + file_answers_text(result) + single_ray_text(result.candidates);
    return text + fmt::format("Times are of this run: {} of the {} against {} of its primitives.\n",
                              text::count_with_noun(result.timed.ray_count, "ray"),
                              result.request.rays ? "file" : "scene", result.timed.primitive_count);
}

}  // namespace lostbits::output::choose
