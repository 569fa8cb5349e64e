// The verdict on an explained ray: the answer, the cause of the loss, the operation to blame, and forms that do better.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "measure/attribution/explanation.hpp"
#include "measure/stability/stability.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/attribution/operation_view.hpp"
#include "output/file/number_text.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::output::attribution {

using intersect::StopReason;

namespace {

/// Sentence for a form that only answers hit or miss, without t.
std::string decision_sentence(const Explanation& explanation) {
    const Outcome outcome = explanation.result.outcome;
    const bool says_hit = outcome == Outcome::agree_hit || outcome == Outcome::false_hit;
    const bool is_right = outcome == Outcome::agree_hit || outcome == Outcome::agree_miss;
    if (!is_right && !says_hit && outcome != Outcome::false_miss)
        return "The true answer for this ray could not be proved.";
    return fmt::format("{} answers {}, {} the ray {}: a {} {}.", explanation.form->info->name, says_hit ? "yes" : "no",
                       is_right ? "and" : "but",
                       explanation.true_t ? fmt::format("hits at {}", number_phrase(*explanation.true_t)) : "misses",
                       is_right ? "correct" : "false", says_hit ? "hit" : "miss");
}

std::string outcome_sentence(const Explanation& explanation) {
    const std::string form(explanation.form->info->name);
    const double t = explanation.result.t, true_t = explanation.true_t.value_or(0);
    if (!explanation.returns_t()) return decision_sentence(explanation);
    if (explanation.result.outcome == Outcome::wrong_primitive)
        return fmt::format("{} reports a hit at {}, on another primitive than the one that the ray meets first, at {}.",
                           form, number_phrase(t), number_phrase(true_t));
    const std::string decision_line = decision_text(form, explanation.result.outcome, t, true_t);
    if (!decision_line.empty()) return decision_line;

    // Both hit.
    if (!std::isfinite(explanation.result.ulps))
        return fmt::format("t is {}, the true t is {}: all {} bits lost.", number_phrase(t), number_phrase(true_t),
                           explanation.format.parameters.precision);
    return fmt::format(
        "t = {} ({}), the true t is {}: {:.4g} ulp off, {:.1f} of {} bits lost.{}", file::decimal(t), file::hex(t),
        file::decimal(true_t), explanation.result.ulps, explanation.result.lost_bits,
        explanation.format.parameters.precision,
        is_wrong_root(explanation)
            ? " Perhaps the wrong root: another crossing of the same primitive is nearer to t than the true one."
            : "");
}

/// `beyond tmax = 3.9`, `before tmin = 5`; for a hit at the end itself, `at tmax = 4` with the reason why it is
/// outside.
std::string outside_phrase(double t, const char* relation, const char* name, double end, bool is_open) {
    if (t != end) return fmt::format("{} {} = {}", relation, name, number_phrase(end));
    return fmt::format("at {} = {}, {}", name, number_phrase(end),
                       is_open ? "which is open" : "where touching is not a hit");
}

/// Sentence that says where a ray would hit that misses only because of its range. Empty for other rays.
std::string range_sentence(const Explanation& explanation) {
    std::vector<std::string> clauses;
    const auto add = [&](const std::optional<double>& t, const char* relation, const char* name, double end,
                         bool is_open) {
        if (t)
            clauses.push_back(
                fmt::format("at t = {} lies {}", number_phrase(*t), outside_phrase(*t, relation, name, end, is_open)));
    };
    add(explanation.t_before_tmin, "before", "tmin", explanation.range.tmin, explanation.range.open_ends.tmin);
    add(explanation.t_beyond_tmax, "beyond", "tmax", explanation.range.tmax, explanation.range.open_ends.tmax);
    if (clauses.empty()) return "";
    return fmt::format(" The exact hit {}{}.", clauses.front(),
                       clauses.size() > 1 ? ", and that " + clauses.back() : "");
}

/// Text for a hit of the wrong primitive: the primitive that the form hits, the one that the ray meets first, the
/// form's answer for the latter alone, and the command that explains that answer.
std::string wrong_primitive_sentence(const Explanation& explanation) {
    const measure::attribution::TruePrimitive& missed = *explanation.missed_primitive;
    const std::string reported = missed.hit
                                     ? fmt::format("a hit at {}, {}", number_phrase(missed.t),
                                                   missed.t > explanation.result.t ? "behind" : "which is not before")
                                     : "a miss";
    const Shape missed_shape = missed.ray_and_primitive.primitives.front().shape;
    const auto label_of = [&explanation](int primitive, Shape shape) {
        return explanation.form->is_set() ? fmt::format("{}, {}", primitive, with_article(shape))
                                          : std::to_string(primitive);
    };
    return fmt::format(
        "The wrong primitive: the form hits primitive {}, but the ray first meets primitive {} (counted from 0). For "
        "that primitive alone it reports {}. The text below is about primitive {}; the command for the other one is: "
        "{}\n",
        label_of(explanation.primitive_index, explanation.shape), label_of(missed.index, missed_shape), reported,
        explanation.primitive_index,
        explain_command(explain_ray_arguments(&missed.ray_and_primitive),
                        {&explanation.form->form_for(missed_shape), explanation.format, explanation.touching}));
}

/// Part of the error that is due to rounding, in ulps; NaN unless form and truth agree on a hit and the tape explains
/// t.
double rounding_ulps(const Explanation& explanation) {
    if (explanation.result.outcome != Outcome::agree_hit || !explanation.has_tape() ||
        explanation.attribution.subject != explanation.tape.outputs.t)
        return NAN;
    return explanation.attribution.error / explanation.ulp_of_subject();
}

/// True if less than a bit of the loss is due to rounding: rounding causes less than an ulp, or more than half of the
/// error would remain without it.
bool rounding_costs_little(const Explanation& explanation) {
    return std::fabs(rounding_ulps(explanation)) < std::max(1.0, std::fabs(explanation.result.ulps) / 2);
}

bool is_mostly_not_rounding(const Explanation& explanation) {
    return explanation.result.lost_bits >= min_notable_bits && rounding_costs_little(explanation);
}

/// Three digits of a number, or the name of a number that is not finite.
std::string size_phrase(double explanation) {
    return std::isfinite(explanation) ? short_number(explanation) : number_phrase(explanation);
}

/// Sentence on an answer that a march gave or did not reach.
std::string march_sentence(const Explanation& explanation, const MarchEnd& march) {
    const auto& [log, constants] = march;
    const std::size_t sample_count = log.steps.size();
    const double d = sample_count > 0 ? log.steps.back().d : NAN;

    // A hit beside the surface.
    if (explanation.result.outcome == Outcome::agree_hit) {
        const double t_error = explanation.result.t - explanation.true_t.value_or(NAN);
        return fmt::format(
            "The march ended at sample {} of at most {}, where the field is {}: {} {} the surface. This is intended "
            "({}) and not due to rounding.",
            sample_count, constants.max_steps, size_phrase(d), size_phrase(std::fabs(t_error)),
            t_error < 0 ? "short of" : "behind", explanation.form->info->title);
    }

    // A march that ended before it reached the surface.
    if (explanation.result.outcome != Outcome::false_miss) return "";
    switch (log.stop) {
        case StopReason::max_steps:
            return fmt::format("The march used all its {} samples and was then {} away from a surface.",
                               constants.max_steps, size_phrase(d));
        case StopReason::stagnated:
            return fmt::format(
                "The march stood still: a step of {} does not change t in {}, so no further sample would help.",
                size_phrase(d), explanation.format.name);
        case StopReason::max_dist:
            return fmt::format("The march went past max_dist = {}.", file::decimal(constants.max_dist));
        case StopReason::hit: break;
    }
    return "";
}

/// The cause of the loss. `envelope_sentence` weighs the problem against the formula; for a march it may be neither.
std::string cause_sentence(const Explanation& explanation, const std::optional<MarchEnd>& march) {
    const bool stopped_short = explanation.result.outcome == Outcome::agree_hit &&
                               is_mostly_not_rounding(explanation) && explanation.excess_bits >= min_notable_bits;
    if (march && (stopped_short || explanation.result.outcome == Outcome::false_miss)) {
        const std::string sentence = march_sentence(explanation, *march);
        if (!sentence.empty()) return sentence;
    }
    return envelope_sentence(explanation);
}

/// Text for a hit of the wrong primitive that rounding caused.
std::string turned_order_sentence(const Explanation& explanation) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const auto exact_result = [](bool hit, double t) {
        return hit ? fmt::format("is hit at {}", number_phrase(t)) : std::string("is missed");
    };
    const std::string order_sentence =
        fmt::format("Rounding changed which primitive comes first: without it primitive {} {}, and primitive {} {}.",
                    explanation.missed_primitive->index, exact_result(true, explanation.missed_primitive->exact_t),
                    explanation.primitive_index,
                    exact_result(attribution.is_exact_hit, attribution[explanation.tape.outputs.t].exact));
    return order_sentence +
           (culprit_operation(explanation) == no_node
                ? fmt::format(" The larger error is that of primitive {}, which the command above explains.",
                              explanation.missed_primitive->index)
                : " " + culprit_sentence(explanation));
}

/// Sentence for a loss of a bit or more of which rounding causes only a small part.
std::string other_cause_sentence(const Explanation& explanation, bool is_march) {
    const bool has_lossy_inputs = explanation.has_rounded_inputs && !(explanation.excess_bits >= min_notable_bits);
    const char* const other_cause = explanation.missed_primitive ? "the answer is for another primitive"
                                    : has_lossy_inputs ? "the rest comes from inputs that the format cannot hold"
                                    : is_march         ? "the rest comes from where the march ended"
                                                       : "the rest comes from what the form assumes";
    const std::string total_ulps = ulps_or_nothing(explanation.result.ulps);
    return fmt::format("No operation is to blame: rounding inside the form causes {}{}, and {}.",
                       short_number(rounding_ulps(explanation)), total_ulps.empty() ? " ulp" : " of the " + total_ulps,
                       other_cause);
}

/// Reason why no operation is to blame for the decision or the loss.
std::string no_blame_sentence(const Explanation& explanation, bool is_march) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const bool agrees_on_hit = explanation.result.outcome == Outcome::agree_hit,
               is_right = explanation.result.is_right();
    const bool decision_changed = explanation.hit != attribution.is_exact_hit && !attribution.loop_was_cut_short;

    // The decision is right.
    if (is_right && decision_changed)
        return fmt::format("No operation is to blame: the decision is right. Without rounding the form would {}.",
                           attribution.is_exact_hit ? "hit" : "miss");
    if (!explanation.returns_t() && is_right) return "No operation is to blame: the decision is right.";

    // No operation contributes, or the value of the culprit is NaN.
    if (attribution.subject == no_node || attribution.culprit == no_node) return culprit_sentence(explanation);
    if (explanation.result.outcome == Outcome::not_a_number && std::isnan(explanation.tape[attribution.culprit].value))
        return culprit_sentence(explanation);

    // Rounding is not known to have made the decision wrong.
    if (explanation.hit != attribution.is_exact_hit && attribution.loop_was_cut_short)
        return "No single operation is to blame: without rounding the march would have gone on.";
    if (!agrees_on_hit && decision_changed) return "The true answer is not proved, so no operation is to blame.";
    if (!agrees_on_hit) return "The decision is the same without rounding, so no operation is to blame.";

    // Form and truth hit, and the loss is small or has another cause than rounding.
    if (!std::isfinite(explanation.tape[attribution.culprit].value)) return culprit_sentence(explanation);
    if (explanation.result.lost_bits < min_notable_bits) return "No operation is to blame: less than a bit is lost.";
    if (!rounding_costs_little(explanation)) return "No operation is to blame: none of the roundings reaches t.";
    return other_cause_sentence(explanation, is_march);
}

/// The culprit, and on a second line what its rounding alone causes; or the reason why no operation is to blame.
std::string culprit_paragraph(const Explanation& explanation, bool is_march) {
    if (!explanation.has_tape())
        return "Its operations are not known, because a compiled function is a black box; write it as a form over any "
               "number to see them (docs/your-own-form.md).";
    if (explanation.missed_primitive && explanation.rounding_changed_order()) return turned_order_sentence(explanation);
    if (culprit_operation(explanation) == no_node) return no_blame_sentence(explanation, is_march);
    const std::string counterfactual = counterfactual_sentence(explanation);
    return culprit_sentence(explanation) + (counterfactual.empty() ? "" : "\n" + counterfactual);
}

/// `a correct miss`, `4.6 bits lost`.
std::string outcome_text(const measure::attribution::FormResult& result) {
    switch (result.outcome) {
        case Outcome::agree_hit:
            return std::isnan(result.lost_bits) ? "a correct hit" : fmt::format("{:.1f} bits lost", result.lost_bits);
        case Outcome::agree_miss: return "a correct miss";
        case Outcome::false_hit: return "a false hit";
        case Outcome::false_miss: return "a false miss";
        case Outcome::not_a_number: return "a hit at NaN";
        case Outcome::wrong_primitive: return "a hit of the wrong primitive";
        case Outcome::crack: return "a crack in the mesh";
        case Outcome::double_hit: return "a double hit";
        case Outcome::wrong_neighbour: return "a hit of the neighbouring triangle";
        case Outcome::out_of_order: return "two triangles out of order";
        case Outcome::unresolved: break;
    }
    return "its true answer could not be proved";
}

/// Sentences on the forms named with `--beside` that are not in `listed`, the forms already listed as better.
std::string beside_sentences(const Explanation& explanation,
                             const std::vector<const intersect::table::Intersector*>& listed) {
    std::string text;
    for (const measure::attribution::FormResult& result : explanation.compared_forms) {
        const auto& name = result.form->info->name;
        if (result.has_other_truth)
            text += fmt::format(
                "{} has another contract, so another answer is right for this ray. By its own contract: {}.\n", name,
                outcome_text(result));
        else if (std::ranges::find(listed, result.form) == listed.end())
            text +=
                fmt::format("{} does no better on this ray and around it{}: {}.\n", name,
                            result.mean_lost_nearby < explanation.result.mean_lost_nearby ? ", by a bit or more" : "",
                            outcome_text(result));
    }

    for (const auto* form : explanation.incomparable_forms)
        text += !(form->shapes() == explanation.form->shapes())
                    ? fmt::format("{} is a form for another shape, so it was not tried.\n", form->info->name)
                    : fmt::format("{} does not exist in {}, so it was not tried.\n", form->info->name,
                                  explanation.format.name);
    return text;
}

/// True if a form is worth a mention. If the answer is right, the form must keep a bit more around the ray.
bool is_notably_better(const Explanation& explanation, const measure::attribution::FormResult& result) {
    return !explanation.result.is_right() ||
           explanation.result.mean_lost_nearby - result.mean_lost_nearby >= min_notable_bits;
}

/// Rays over which the loss around a ray is averaged.
std::string neighbourhood_phrase(const Explanation& explanation) {
    return explanation.nearby_pixel_count > 0
               ? fmt::format("{} pixels around it", explanation.nearby_pixel_count)
               : fmt::format("{} rays around it, with each number within an ulp of its own value",
                             measure::attribution::neighbour_count);
}

}  // namespace

std::string better_forms_text(const Explanation& explanation) {
    // Lists the best forms, and in any case those that the user asked for.
    std::string list;
    constexpr std::size_t max_forms = 6;
    std::vector<const intersect::table::Intersector*> listed;
    std::size_t unlisted_count = 0;
    for (const measure::attribution::FormResult& result : explanation.better_forms) {
        if (!is_notably_better(explanation, result)) continue;
        const bool is_requested =
            std::ranges::find(explanation.compared_forms, result.form, &measure::attribution::FormResult::form) !=
            explanation.compared_forms.end();
        if (listed.size() >= max_forms && !is_requested) {
            ++unlisted_count;
            continue;
        }
        list += fmt::format("{} {} ({}, {:.1f} around)", listed.empty() ? "" : ",", result.form->info->name,
                            outcome_text(result), result.mean_lost_nearby);
        listed.push_back(result.form);
    }

    if (listed.empty())
        return fmt::format("No other form that was tried does better on this ray in this format and around it{}.\n",
                           explanation.better_forms.empty() ? "" : ", by a bit or more") +
               beside_sentences(explanation, listed);
    return fmt::format(
               "Better on this ray and around it:{}{}.\nOn {}, {} loses {:.1f} bits on average; a wrong decision "
               "counts as all {}.\n",
               list, unlisted_count > 0 ? fmt::format(" and {} more", unlisted_count) : "",
               neighbourhood_phrase(explanation), explanation.form->info->name, explanation.result.mean_lost_nearby,
               explanation.format.parameters.precision) +
           beside_sentences(explanation, listed);
}

std::string decision_text(const std::string& form, Outcome outcome, double t, double true_t) {
    switch (outcome) {
        case Outcome::agree_miss: return form + " misses, and so does the exact ray: a correct miss.";
        case Outcome::false_hit:
            return fmt::format("{} reports a hit at {}, but the ray misses: a false hit.", form, number_phrase(t));
        case Outcome::false_miss:
            return fmt::format("{} reports a miss, but the ray hits at {}: a false miss.", form, number_phrase(true_t));
        case Outcome::not_a_number: return form + " reports a hit at NaN.";
        case Outcome::unresolved: return "The true answer for this ray could not be proved.";
        default: return "";  // outcomes of a whole mesh: the explained answer is that of one primitive
    }
}

bool is_wrong_root(const Explanation& explanation) {
    const bool is_far_off = explanation.result.outcome == Outcome::agree_hit && std::fabs(explanation.result.ulps) > 8;
    if (!is_far_off || !explanation.true_t || !is_primitive(explanation.form->shape) || explanation.missed_primitive)
        return false;
    const Primitive<double> primitive(explanation.shape);
    const std::size_t range_input_count = explanation.range.is_whole() ? 1 : 2;
    if (explanation.input_values.size() != 6 + primitive.shape_numbers().size() + range_input_count)
        return false;  // with a transform
    return measure::stability::is_wrong_root(measure::tape::ray_of(explanation.input_values),
                                             measure::tape::primitive_of(explanation.input_values, primitive),
                                             measure::truth::as_certified(*explanation.true_t), explanation.result.t);
}

NodeId culprit_operation(const Explanation& explanation) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    if (attribution.subject == no_node || attribution.culprit == no_node ||
        measure::attribution::is_plain_miss(explanation.tape, attribution))
        return no_node;

    const Outcome outcome = explanation.result.outcome;
    const bool is_about_decision = is_decision(explanation.tape[attribution.subject].op),
               lost_a_bit = explanation.result.lost_bits >= min_notable_bits;
    const bool is_not_finite = !std::isfinite(explanation.tape[attribution.culprit].value);
    if (outcome == Outcome::unresolved || (attribution[attribution.culprit].contribution == 0 && !is_not_finite))
        return no_node;

    // A culprit is to blame for a wrong decision, a lost bit, a wrong order of primitives, or a NaN.
    bool is_blamed = false;
    if (is_about_decision) is_blamed = !explanation.result.is_right();
    else if (outcome == Outcome::agree_hit)
        is_blamed = lost_a_bit && (is_not_finite || !rounding_costs_little(explanation));
    else if (outcome == Outcome::wrong_primitive && explanation.rounding_changed_order() && attribution.is_exact_hit)
        is_blamed = std::fabs(attribution.error) >=
                    std::fabs(explanation.missed_primitive->hit
                                  ? explanation.missed_primitive->t - explanation.missed_primitive->exact_t
                                  : HUGE_VAL);
    else
        is_blamed =
            is_not_finite && outcome == Outcome::not_a_number && !std::isnan(attribution[attribution.culprit].exact);
    return is_blamed ? attribution.culprit : no_node;
}

bool rounding_explains(const Explanation& explanation) {
    return std::fabs(explanation.result.ulps - rounding_ulps(explanation)) <= 1;
}

/// Outcome for all triangles of a mesh together, as in a map: docs/meshes.md.
std::string mesh_sentence(const Explanation& explanation) {
    switch (explanation.mesh_outcome.value_or(Outcome::agree_hit)) {
        case Outcome::crack:
            return "In the mesh this is a crack: the form claims neither the triangle that the ray meets first nor a "
                   "neighbour of it, and the number of crossings is wrong by an odd number.\n";
        case Outcome::double_hit:
            return "In the mesh this is a double hit: the form also claims a neighbouring triangle, although the ray "
                   "crosses the mesh once.\n";
        case Outcome::wrong_neighbour:
            return "In the mesh this is a wrong neighbour, which is not a wrong decision: the triangles share a "
                   "vertex.\n";
        case Outcome::out_of_order:
            return "In the mesh this is out of order: the form accepts a triangle that the ray truly meets before this "
                   "one, but its t there is not the smaller one.\n";
        case Outcome::agree_hit:
            return explanation.mesh_outcome
                       ? "In the mesh this is a correct hit: the ray meets both triangles at the same t.\n"
                       : "";
        default: return "";
    }
}

std::string ExplainedVerdict::text() const { return answer + "\n" + loss + "\n" + blame + "\n"; }

ExplainedVerdict make_verdict(const Explanation& explanation, const std::optional<MarchEnd>& march) {
    std::string answer = outcome_sentence(explanation) + range_sentence(explanation) + "\n" +
                         (explanation.missed_primitive ? wrong_primitive_sentence(explanation) : "") +
                         mesh_sentence(explanation);
    answer.pop_back();
    return {.answer = std::move(answer),
            .loss = cause_sentence(explanation, march),
            .blame = culprit_paragraph(explanation, march.has_value()),
            .culprit = culprit_operation(explanation)};
}

}  // namespace lostbits::output::attribution
