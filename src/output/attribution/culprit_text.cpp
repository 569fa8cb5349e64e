// Sentences about the culprit of an explained ray.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/attribution/attribution.hpp"
#include "measure/attribution/operation_error.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/attribution/operation_view.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

namespace {

/// Returns a sentence for an answer that is not finite because the format made an input infinite or NaN.
std::optional<std::string> not_finite_input_sentence(const Explanation& explanation) {
    const NodeId subject = explanation.attribution.subject;
    if (is_decision(explanation.tape[subject].op) || std::isfinite(explanation.tape[subject].value)) return {};
    for (std::size_t i = 0; i < explanation.input_values.size(); ++i) {
        if (!std::isfinite(explanation.input_values[i]) && explanation.input_names[i] != "ray.tmax")
            return fmt::format("The input {} is {} in {}. Everything after it follows from that.",
                               explanation.input_names[i], number_phrase(explanation.input_values[i]),
                               explanation.format.name);
    }
    return {};
}

/// Returns a sentence on the cancellation that amplifies the culprit's rounding, and on earlier errors of its
/// operands.
std::string amplifier_text(const Explanation& explanation, const OperationView& view) {
    const NodeId amplifier = explanation.find_amplifier(explanation.attribution.culprit);
    if (amplifier == no_node) return "";
    const TapeNode& amplifier_node = explanation.tape[amplifier];
    std::string text =
        fmt::format("{} cancels {} of {} bits", view.text().definition(amplifier),
                    view.error_of(amplifier).cancelled_bits, explanation.tape.format_of(amplifier).precision);

    // The cancellation amplifies the errors that its operands already have.
    const auto& operands = amplifier_node.operands;
    for (auto position = operands.begin(); position != operands.end(); ++position) {
        const NodeId operand = *position;
        if (std::find(operands.begin(), position, operand) != position) continue;  // already named, as in fma(b, b, c)
        if (operand == no_node || view.error_of(operand).error == 0 || explanation.tape[operand].op == TapeOp::constant)
            continue;
        const std::string operand_ulps =
            ulps_or_nothing(std::fabs(view.ulps_of_value(operand, view.error_of(operand).error)));
        if (!operand_ulps.empty())
            text += fmt::format("; {} was already off by {}", view.text().operand(operand), operand_ulps);
    }
    return text + ". ";
}

/// The operations that contribute as much to the error as the culprit, and sentences about them.
class EqualContributions {
public:
    EqualContributions(const Explanation& explanation, const OperationView& view)
        : explanation_(explanation), view_(view), equals_(explanation.attribution.equal_culprits) {
        const auto has_opposite_sign = [&](NodeId i) {
            return std::signbit(view.contribution(i)) !=
                   std::signbit(view.contribution(explanation.attribution.culprit));
        };
        opposite_count_ = static_cast<std::size_t>(std::ranges::count_if(equals_, has_opposite_sign));
    }

    /// True if these operations and the culprit cancel each other.
    [[nodiscard]] bool cancels_culprit() const { return 2 * opposite_count_ == equals_.size() + 1; }
    /// Sum of the contributions of the culprit and these operations.
    [[nodiscard]] double sum() const {
        double sum = view_.contribution(explanation_.attribution.culprit);
        for (const NodeId i : equals_) sum += view_.contribution(i);
        return sum;
    }

    /// Names of the first three of these operations: `b·b, a·c and 2 more`.
    [[nodiscard]] std::string names() const {
        constexpr std::size_t max_names = 3;
        std::vector<std::string> listed_names;
        for (const NodeId i : equals_) {
            if (listed_names.size() < max_names) listed_names.push_back(view_.text().operand(i));
        }
        if (equals_.size() > max_names) listed_names.push_back(fmt::format("{} more", equals_.size() - max_names));
        return file::word_list(listed_names);
    }

    /// `; b·b, from which it is computed, contributes the same with the opposite sign`
    [[nodiscard]] std::string clause() const {
        if (equals_.empty()) return "";
        std::string text = "; " + names();
        const bool culprit_uses_all = std::ranges::all_of(equals_, [&](NodeId i) {
            return measure::attribution::is_computed_from(explanation_.tape, explanation_.attribution,
                                                          explanation_.attribution.culprit, i);
        });
        text += culprit_uses_all ? ", from which it is computed, contribute" : " contribute";
        if (equals_.size() == 1) text += "s";
        text += " the same";
        if (opposite_count_ == equals_.size()) return text + " with the opposite sign";
        return opposite_count_ == 0 ? text : text + fmt::format(", {} of them with the opposite sign", opposite_count_);
    }

private:
    const Explanation& explanation_;
    const OperationView& view_;
    const std::vector<NodeId>& equals_;
    std::size_t opposite_count_;
};

/// Text for a culprit that its equals cancel: the error that remains, and the operation with the largest share of it.
std::string remaining_error_text(const Explanation& explanation, const OperationView& view) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const std::string undo_clause =
        attribution.equal_culprits.size() == 1 ? ". The two undo each other" : ". They undo each other";
    if (attribution.error == 0) return undo_clause + ", and no error is left";

    // The other operations are those that contribute less than the culprit and its equals.
    double smallest_contribution = std::fabs(view.error_of(attribution.culprit).contribution);
    for (const NodeId i : attribution.equal_culprits)
        smallest_contribution = std::min(smallest_contribution, std::fabs(view.error_of(i).contribution));
    const auto other_operations = find_largest_contributions(explanation.tape, attribution, smallest_contribution);

    const std::string remaining_ulps = ulps_or_nothing(std::fabs(attribution.error / view.ulp()));
    if (remaining_ulps.empty()) return undo_clause;
    if (other_operations.empty()) return fmt::format("{}, and an error of {} is left", undo_clause, remaining_ulps);
    return fmt::format(
        "{}: the error of {} comes from the other operations, the largest part, {} ulp, from "
        "{}",
        undo_clause, remaining_ulps, short_number(std::fabs(view.contribution(other_operations.front()))),
        view.text().operand(other_operations.front()));
}

/// Phrase for the error that the culprit itself makes: a rounding, a wrong choice, or a step to the next number. Gives
/// its size in ulps if that is finite.
std::string culprit_error_phrase(const Explanation& explanation, const OperationView& view) {
    const NodeId culprit = explanation.attribution.culprit;
    const measure::attribution::OperationError& operation_error = view.error_of(culprit);
    const std::string ulps = ulps_or_nothing(std::fabs(view.ulps_of_value(culprit, operation_error.rounding)));
    const char* const error_kind = operation_error.decision_changed                                    ? "wrong choice"
                                   : measure::attribution::is_on_purpose(explanation.tape[culprit].op) ? "step"
                                                                                                       : "rounding";
    return ulps.empty() ? error_kind : fmt::format("{} of {}", error_kind, ulps);
}

/// `has no finite share in t, which is off by 12 ulp`: clause for a culprit whose contribution is not finite.
std::string no_finite_share_text(const Explanation& explanation, const OperationView& view, const std::string& target,
                                 const EqualContributions& equals) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const std::string others_clause = attribution.equal_culprits.empty() ? "" : fmt::format(", as {}", equals.names());
    const std::string error_ulps = ulps_or_nothing(std::fabs(attribution.error / view.ulp()));
    return fmt::format("has no finite share {}{}{}.", target, others_clause,
                       error_ulps.empty() ? "" : fmt::format(", which is off by {}", error_ulps));
}

/// Compares the sum of the culprit and its equals with the whole error: `, 73 % of the error`. Empty if the two cannot
/// be compared.
std::string error_fraction_clause(const Explanation& explanation, const OperationView& view, double sum) {
    const double error = explanation.attribution.error, fraction = sum * view.ulp() / error;
    // The text has as many digits as that of `counterfactual_sentence`, which often repeats the number.
    const double remaining_ulps = std::fabs(error / view.ulp());
    if (fraction > 1 && std::isfinite(remaining_ulps))
        return fmt::format("; the other roundings cancel all but {:.4g} ulp of that", remaining_ulps);
    if (fraction < 0 && std::isfinite(remaining_ulps))
        return fmt::format(
            "; the other roundings together have the opposite sign and are larger: the error is "
            "{:.4g} ulp",
            remaining_ulps);
    if (std::isfinite(fraction) && fraction >= 0 && fraction <= 1)
        return fmt::format(", {:.0f} % of the error", 100 * fraction);
    return "";
}

/// `accounts for 3940 ulp in t`, and the operations that contribute the same.
std::string contributions_text(const Explanation& explanation, const OperationView& view) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const std::string target = is_decision(explanation.tape[attribution.subject].op)
                                   ? fmt::format("in {}", view.text().expression(attribution.subject))
                                   : "in t";
    const EqualContributions equals(explanation, view);
    const std::string assigned_ulps = ulps_or_nothing(std::fabs(view.contribution(attribution.culprit)));
    if (assigned_ulps.empty()) return no_finite_share_text(explanation, view, target, equals);

    std::string text = fmt::format("accounts for {} {}{}", assigned_ulps, target, equals.clause());
    if (equals.cancels_culprit()) return text + remaining_error_text(explanation, view) + ".";
    if (!attribution.equal_culprits.empty())
        text += fmt::format(": together {} ulp", short_number(std::fabs(equals.sum())));
    return text + error_fraction_clause(explanation, view, equals.sum()) + ".";
}

/// Sentence for a ray without a subject: rounding changed no decision, or no comparison shows why it changed one.
std::string no_subject_sentence(const Explanation& explanation) {
    const bool is_exact_hit = explanation.attribution.is_exact_hit;
    if (explanation.hit == is_exact_hit)
        return "Rounding changed no decision of the form, so no operation is to blame.";
    return fmt::format("No single operation is to blame: without rounding the form {}, and no comparison shows why.",
                       is_exact_hit ? "hits" : "misses");
}

/// Sentence on a culprit whose value is infinite or NaN.
std::string not_finite_culprit_sentence(const Explanation& explanation, const OperationView& view, bool is_blamed) {
    const NodeId culprit = explanation.attribution.culprit;
    const std::string definition = view.text().definition(culprit);
    const double value = explanation.tape[culprit].value;
    if (!is_blamed && explanation.result.outcome == measure::answer::Outcome::agree_hit)
        return fmt::format("{} is {}, and so is the rounded true t.", definition, number_phrase(value));
    if (std::isnan(value) && std::isnan(view.error_of(culprit).exact) && !is_blamed)
        return fmt::format(
            "No operation is to blame: the formula itself gives NaN in {}, even without rounding; all later operations "
            "inherit it.",
            definition);
    return fmt::format("{} is {}. Everything after it follows from that.", definition, number_phrase(value));
}

}  // namespace

std::string culprit_sentence(const Explanation& explanation) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    if (attribution.subject == no_node) return no_subject_sentence(explanation);
    if (measure::attribution::is_plain_miss(explanation.tape, attribution))
        return "Rounding changed no decision of the form, so no operation is to blame.";

    const OperationView view(explanation);
    if (attribution.culprit == no_node)
        return not_finite_input_sentence(explanation).value_or("No operation rounded on the way to the answer.");
    const TapeNode& node = explanation.tape[attribution.culprit];
    const bool is_blamed = culprit_operation(explanation) != no_node;
    if (!std::isfinite(node.value)) return not_finite_culprit_sentence(explanation, view, is_blamed);

    const std::string culprit_definition = view.text().definition(attribution.culprit);
    if (measure::attribution::is_on_purpose(node.op))
        return fmt::format("{}: the form goes to the next number on purpose, in {}. That {} {}",
                           is_blamed ? "No rounding is to blame" : "The largest contribution is not a rounding",
                           culprit_definition, culprit_error_phrase(explanation, view),
                           contributions_text(explanation, view));
    return fmt::format("{}{} {}: its {} {}", amplifier_text(explanation, view),
                       is_blamed ? "The culprit is" : "The largest contribution is that of", culprit_definition,
                       culprit_error_phrase(explanation, view), contributions_text(explanation, view));
}

std::string counterfactual_sentence(const Explanation& explanation) {
    if (!explanation.culprit_alone || explanation.attribution.subject == no_node) return "";

    const OperationView view(explanation);
    const auto& [only_exact, only_rounded] = *explanation.culprit_alone;
    const NodeId culprit = explanation.attribution.culprit;
    const bool is_step = measure::attribution::is_on_purpose(explanation.tape[culprit].op);
    const std::string culprit_name = view.text().operand(culprit),
                      if_only_exact =
                          is_step ? "Without " + culprit_name + "," : "If " + culprit_name + " alone were exact,",
                      if_only_rounded =
                          is_step ? "With " + culprit_name + " alone," : "If " + culprit_name + " alone were rounded,";

    // If the subject is a decision, the sentence says hit or miss.
    if (explanation.attribution.subject != explanation.tape.outputs.t) {
        const auto verb_of = [](bool hit) { return hit ? "hit" : "miss"; };
        return fmt::format("{} the form would {}{}. {} it would {}.", if_only_exact,
                           only_exact.hit == explanation.hit ? "still " : "", verb_of(only_exact.hit), if_only_rounded,
                           verb_of(only_rounded.hit));
    }

    const auto ulps_off = [&view](const measure::attribution::Counterfactual& counterfactual) {
        return fmt::format("{:.4g} ulp", std::fabs(counterfactual.error / view.ulp()));
    };

    // The sentence on the culprit alone would suggest that repairing this operation is enough.
    const bool hardly_helps = !is_step && only_exact.hit && std::isfinite(only_exact.error) &&
                              std::fabs(only_exact.error) > std::fabs(explanation.attribution.error) / 2;
    const auto effect_of = [&](const measure::attribution::Counterfactual& counterfactual, const char* still) {
        if (!counterfactual.hit) return std::string("the form would miss");
        return std::isfinite(counterfactual.error) ? fmt::format("t would {}be {} off", still, ulps_off(counterfactual))
                                                   : "t would not be finite";
    };
    return fmt::format("{} {}{}. {} {}.", if_only_exact, effect_of(only_exact, hardly_helps ? "still " : ""),
                       hardly_helps ? ", so repairing it alone does not help much" : "", if_only_rounded,
                       effect_of(only_rounded, ""));
}

}  // namespace lostbits::output::attribution
