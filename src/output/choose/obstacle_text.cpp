// Lines on what keeps every candidate from the requirement (see `obstacle_text`).
#include "output/choose/choice_files.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/file/number_text.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::choose {

using measure::choose::Input;
using measure::choose::InputTrial;

namespace {

std::string bits_text(double kept, const Requirement& requirement, double distance_error = measure::truth::missing) {
    return std::isnan(kept)
               ? "no hit"
               : kept_bits_text(kept, requirement) + " bits" + distance_error_text(distance_error, requirement);
}

/// Bits kept, and the wrong decisions if the requirement does not allow them.
std::string kept_and_wrong(const FormQuality& quality, const Requirement& requirement) {
    const std::string kept = bits_text(quality.kept_bits, requirement, quality.distance_error);
    if (quality.decides_as_required(requirement)) return kept;
    return fmt::format("{} and decides {} of {} wrongly", kept, quality.wrong_count,
                       text::count_with_noun(quality.ray_count, "ray"));
}

/// `the centres and the radii`.
std::string inputs_text(const InputTrial& trial, std::string_view position_names) {
    std::vector<std::string> names;
    for (const auto& [input, name] : {std::pair(Input::origin, std::string("ray origins")),
                                      {Input::direction, "directions"},
                                      {Input::place, std::string(position_names)},
                                      {Input::radius, "radii"}})
        if (trial.is_wide(input)) names.push_back("the " + name);
    return file::word_list(names);
}

/// Sentence on the inputs that would have to be wider, and in which format.
std::string required_inputs_text(const ChoiceResult& result, const Candidate& nearest) {
    const Obstacle& obstacle = *result.obstacle;
    const Requirement& requirement = result.request.requirement;
    const Shape shape = nearest.tested_form.form->shape;
    const std::string_view position_names = is_primitive(shape) ? row_of(shape).texts.anchor_points : "centres";
    const auto form_in_f64 = [&nearest, &requirement](const InputTrial& trial) {
        return trial.form ? fmt::format("; {} in f64 keeps {}", nearest.tested_form.form->info->name,
                                        kept_and_wrong(*trial.form, requirement))
                          : std::string();
    };

    const char* const wider_format = obstacle.wide_inputs_are_exact ? "more than binary64" : "binary64";
    if (!obstacle.sufficient_trial) {
        const InputTrial& all_wider = obstacle.trials.back();
        return fmt::format("  Even with all inputs in {}, exact arithmetic keeps only {}{}.\n", wider_format,
                           kept_and_wrong(all_wider.exact, requirement), form_in_f64(all_wider));
    }

    const InputTrial& trial = obstacle.trials[*obstacle.sufficient_trial];
    const bool all_needed = &trial == &obstacle.trials.back();
    return fmt::format(
        "  The bits are lost by rounding {}. With {} in {} (at least {} bits are needed){}, exact arithmetic keeps "
        "{}{}.\n",
        all_needed ? "all inputs" : inputs_text(trial, position_names), all_needed ? "all of them" : "these",
        wider_format, obstacle.min_precision, all_needed ? "" : " and the others as they are",
        kept_and_wrong(trial.exact, requirement), form_in_f64(trial));
}

/// Compares the scene stored in binary32 with the scene as it is written.
std::string rounded_scene_text(const ChoiceResult& result, const Candidate& nearest) {
    const Obstacle& obstacle = *result.obstacle;
    const Requirement& requirement = result.request.requirement;
    if (!obstacle.rounds_to_binary32_first || obstacle.trials.empty()) return "";
    const FormQuality& exact = obstacle.trials.front().exact;
    if (exact.meets(requirement)) return "";
    return fmt::format(
               "  In addition, every format gets the scene rounded to binary32, and its answers are judged for this "
               "rounded scene. Compared with the scene as written, even exact arithmetic on the rounded scene keeps "
               "only {}.\n",
               kept_and_wrong(exact, requirement)) +
           required_inputs_text(result, nearest);
}

/// Text for a scene or a file that none of the rays hits.
std::string no_hit_text(const ChoiceResult& result, const Candidate& nearest) {
    if (nearest.quality.true_hit_count > 0)
        return "  What limits it is not known: only some of the rays were examined for that, and none "
               "of them truly hits anything.\n";
    return fmt::format(
        "  What limits it: the {}. None of the rays truly hits anything, so no t has bits to "
        "keep.\n",
        result.request.rays ? "file" : "scene");
}

/// Text for a format with fewer bits than are required.
std::string narrow_format_text(const ChoiceResult& result, const Candidate& nearest) {
    return fmt::format("  What limits it: {} has {} bits. Try a wider format.\n", nearest.tested_form.format.name,
                       nearest.tested_form.format.parameters.precision) +
           rounded_scene_text(result, nearest);
}

/// Text for inputs whose rounding alone costs more than the requirement leaves.
std::string rounded_inputs_text(const ChoiceResult& result, const Candidate& nearest) {
    return fmt::format("  What limits it: the inputs. Even exact arithmetic on them, rounded to {}, keeps only {}.\n",
                       input_format_name(result.obstacle->base_format),
                       kept_and_wrong(result.obstacle->exact, result.request.requirement)) +
           required_inputs_text(result, nearest);
}

/// Bits that half an ulp of the format in each input leaves.
std::string remaining_bits_text(const ChoiceResult& result) {
    return bits_text(result.obstacle->inherent_kept, result.request.requirement, result.obstacle->inherent_distance);
}

/// Text for a problem whose condition costs more than the requirement leaves.
std::string ill_conditioned_text(const ChoiceResult& result, const Candidate& nearest) {
    const Obstacle& obstacle = *result.obstacle;
    const std::string& format = nearest.tested_form.format.name;
    const int precision = nearest.tested_form.format.parameters.precision;
    const std::string f64_sentence =
        format == "f64" ? ""
                        : fmt::format(" Half an ulp of f64 would leave {}.",
                                      bits_text(obstacle.inherent_kept_f64, result.request.requirement));
    return fmt::format(
               "  What limits it: the problem, not the formula. Half an ulp of {} in each input would cost "
               "{:.1f} of its {} bits and leave {}. Forms keep more than that only where inputs need no "
               "rounding.{}\n",
               format, precision - obstacle.inherent_kept, precision, remaining_bits_text(result), f64_sentence) +
           rounded_scene_text(result, nearest);
}

/// Text for a form whose own arithmetic costs the bits or the decisions.
std::string formula_text(const ChoiceResult& result, const Candidate& nearest) {
    const Obstacle& obstacle = *result.obstacle;
    const char* const limit = nearest.quality.decides_as_required(result.request.requirement)
                                  ? "the formula"
                                  : "its decisions, due to the formula";
    const std::string inputs_sentence =
        obstacle.trials.empty() && !obstacle.rounds_to_binary32_first
            ? "The effect of rounding the inputs was not measured, because there are too many primitives"
            : fmt::format(
                  "Exact arithmetic on the same inputs meets the requirement, and half an ulp of {} in each of them "
                  "would leave {}",
                  nearest.tested_form.format.name, remaining_bits_text(result));
    return fmt::format("  What limits it: {}. {}.\n", limit, inputs_sentence) + rounded_scene_text(result, nearest);
}

}  // namespace

std::string input_format_name(const FloatFormat& format) {
    if (format == binary32) return "binary32";
    if (format == binary64) return "binary64";
    return fmt::format("p{}", format.precision);
}

std::string obstacle_text(const ChoiceResult& result, const Candidate& nearest) {
    switch (result.obstacle->cause) {
        case Obstacle::Cause::no_hit: return no_hit_text(result, nearest);
        case Obstacle::Cause::width: return narrow_format_text(result, nearest);
        case Obstacle::Cause::inputs: return rounded_inputs_text(result, nearest);
        case Obstacle::Cause::inherent: return ill_conditioned_text(result, nearest);
        case Obstacle::Cause::formula: break;
    }
    return formula_text(result, nearest);
}

}  // namespace lostbits::output::choose
