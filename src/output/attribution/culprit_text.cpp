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

/// For an answer that is not finite: a sentence on the input that the format already made infinite or NaN.
std::optional<std::string> lost_input(const Explanation& x) {
    const NodeId subject = x.attribution.subject;
    if (is_decision(x.tape[subject].op) || std::isfinite(x.tape[subject].value)) return {};
    for (std::size_t i = 0; i < x.inputs.size(); ++i) {
        if (!std::isfinite(x.inputs[i]) && x.names[i] != "ray.tmax")
            return fmt::format("The input {} is {} in {}. Everything after it follows from that.", x.names[i],
                               number_phrase(x.inputs[i]), x.format.name);
    }
    return {};
}

/// Sentence on the cancellation that amplifies the culprit's rounding, and on earlier errors of its operands.
std::string amplifier_text(const Explanation& x, const OperationView& view) {
    const NodeId amplifier = x.amplifier(x.attribution.culprit);
    if (amplifier == no_node) return "";
    const TapeNode& a = x.tape[amplifier];
    std::string text = fmt::format("{} cancels {} of {} bits", view.text().definition(amplifier),
                                   view.of(amplifier).cancelled, x.tape.format_of(amplifier).precision);
    const auto& operands = a.operands;
    for (auto place = operands.begin(); place != operands.end(); ++place) {
        const NodeId operand = *place;
        if (std::find(operands.begin(), place, operand) != place) continue;  // already named, as in fma(b, b, c)
        if (operand == no_node || view.of(operand).error == 0 || x.tape[operand].op == TapeOp::constant) continue;
        const std::string off = ulps_or_nothing(std::fabs(view.ulps_of_value(operand, view.of(operand).error)));
        if (!off.empty()) text += fmt::format("; {} was already off by {}", view.text().operand(operand), off);
    }
    return text + ". ";
}

/// Operations that contribute as much as the culprit.
class EqualsText {
public:
    EqualsText(const Explanation& x, const OperationView& view) : x_(x), view_(view), equals_(x.attribution.equals) {
        const auto is_opposite = [&](NodeId i) {
            return std::signbit(view.contribution(i)) != std::signbit(view.contribution(x.attribution.culprit));
        };
        opposite_ = static_cast<std::size_t>(std::ranges::count_if(equals_, is_opposite));
    }

    /// True if they and the culprit cancel each other.
    [[nodiscard]] bool cancel() const { return 2 * opposite_ == equals_.size() + 1; }
    /// Sum of the contributions of the culprit and these operations.
    [[nodiscard]] double sum() const {
        double sum = view_.contribution(x_.attribution.culprit);
        for (const NodeId i : equals_) sum += view_.contribution(i);
        return sum;
    }

    /// Names of the first of them: `b·b, a·c and 2 more`.
    [[nodiscard]] std::string names() const {
        constexpr std::size_t most = 3;
        std::vector<std::string> named;
        for (const NodeId i : equals_) {
            if (named.size() < most) named.push_back(view_.text().operand(i));
        }
        if (equals_.size() > most) named.push_back(fmt::format("{} more", equals_.size() - most));
        return file::enumerated(named);
    }

    /// `; b·b, from which it is computed, contributes the same with the opposite sign`
    [[nodiscard]] std::string equals_clause() const {
        if (equals_.empty()) return "";
        std::string text = "; " + names();
        const bool before = std::ranges::all_of(equals_, [&](NodeId i) {
            return measure::attribution::is_computed_from(x_.tape, x_.attribution, x_.attribution.culprit, i);
        });
        text += before ? ", from which it is computed, contribute" : " contribute";
        if (equals_.size() == 1) text += "s";
        text += " the same";
        if (opposite_ == equals_.size()) return text + " with the opposite sign";
        return opposite_ == 0 ? text : text + fmt::format(", {} of them with the opposite sign", opposite_);
    }

private:
    const Explanation& x_;
    const OperationView& view_;
    const std::vector<NodeId>& equals_;
    std::size_t opposite_;
};

/// Text for a culprit that its equals cancel: the remaining error, and the largest part of it.
std::string rest_text(const Explanation& x, const OperationView& view) {
    const measure::attribution::Attribution& a = x.attribution;
    const std::string undo = a.equals.size() == 1 ? ". The two undo each other" : ". They undo each other";
    if (a.error == 0) return undo + ", and no error is left";
    double least = std::fabs(view.of(a.culprit).contribution);
    for (const NodeId i : a.equals) least = std::min(least, std::fabs(view.of(i).contribution));
    const auto others = largest_contributions(x.tape, a, least);
    const std::string left = ulps_or_nothing(std::fabs(a.error / view.ulp()));
    if (left.empty()) return undo;
    if (others.empty()) return fmt::format("{}, and an error of {} is left", undo, left);
    return fmt::format(
        "{}: the error of {} is assigned to the other operations, the largest part, {} ulp, to "
        "{}",
        undo, left, short_number(std::fabs(view.contribution(others.front()))), view.text().operand(others.front()));
}

/// The error that the culprit itself makes: a rounding, a wrong choice, or a step to the next number; with its size in
/// ulps if that is finite.
std::string own_error(const Explanation& x, const OperationView& view) {
    const NodeId culprit = x.attribution.culprit;
    const measure::attribution::OperationError& e = view.of(culprit);
    const std::string ulps = ulps_or_nothing(std::fabs(view.ulps_of_value(culprit, e.rounding)));
    const char* const what = e.turned                                                  ? "wrong choice"
                             : measure::attribution::is_on_purpose(x.tape[culprit].op) ? "step"
                                                                                       : "rounding";
    return ulps.empty() ? what : fmt::format("{} of {}", what, ulps);
}

/// `is assigned 3940 ulp in t`, and the operations that contribute the same.
std::string shares_text(const Explanation& x, const OperationView& view) {
    const measure::attribution::Attribution& a = x.attribution;
    const std::string arrives =
        is_decision(x.tape[a.subject].op) ? fmt::format("in {}", view.text().expression(a.subject)) : "in t";
    const EqualsText equals(x, view);
    const std::string assigned = ulps_or_nothing(std::fabs(view.contribution(a.culprit)));
    if (assigned.empty()) {
        const std::string rest = a.equals.empty() ? "" : fmt::format(", as {}", equals.names());
        const std::string off = ulps_or_nothing(std::fabs(a.error / view.ulp()));
        return fmt::format("has no finite share {}{}{}.", arrives, rest,
                           off.empty() ? "" : fmt::format(", which is off by {}", off));
    }
    std::string text = fmt::format("is assigned {} {}{}", assigned, arrives, equals.equals_clause());
    if (equals.cancel()) return text + rest_text(x, view) + ".";
    if (!a.equals.empty()) text += fmt::format(": together {} ulp", short_number(std::fabs(equals.sum())));
    const double share = equals.sum() * view.ulp() / a.error;
    // As many digits as `counterfactual_sentence` writes, since it often repeats the number.
    const double left = std::fabs(a.error / view.ulp());
    if (share > 1 && std::isfinite(left))
        text += fmt::format("; the other roundings cancel all but {:.4g} ulp of it", left);
    else if (share < 0 && std::isfinite(left))
        text += fmt::format(
            "; the other roundings together have the opposite sign and are larger: the error is "
            "{:.4g} ulp",
            left);
    else if (std::isfinite(share) && share >= 0 && share <= 1)
        text += fmt::format(", {:.0f} % of the error", 100 * share);
    return text + ".";
}

}  // namespace

std::string culprit_sentence(const Explanation& x) {
    const measure::attribution::Attribution& a = x.attribution;
    if (a.subject == no_node) {
        if (x.hit == a.exact_hit) return "Rounding changed no decision of the form, so no operation is to blame.";
        return fmt::format(
            "No single operation is to blame: without rounding the form {}, and no comparison shows why.",
            a.exact_hit ? "hits" : "misses");
    }
    if (measure::attribution::is_plain_miss(x.tape, a))
        return "Rounding changed no decision of the form, so no operation is to blame.";
    const OperationView view(x);
    if (a.culprit == no_node) return lost_input(x).value_or("No operation rounded on the way to the answer.");
    const TapeNode& n = x.tape[a.culprit];
    const std::string what = view.text().definition(a.culprit);
    const bool blamed = culprit_operation(x) != no_node;
    if (!std::isfinite(n.value) && !blamed && x.result.outcome == measure::answer::Outcome::agree_hit)
        return fmt::format("{} is {}, and so is the rounded true t.", what, number_phrase(n.value));
    if (std::isnan(n.value) && std::isnan(view.of(a.culprit).exact) && !blamed)
        return fmt::format(
            "No operation is to blame: {} is not a number even without rounding. Everything after it follows from "
            "that.",
            what);
    if (!std::isfinite(n.value))
        return fmt::format("{} is {}. Everything after it follows from that.", what, number_phrase(n.value));
    if (measure::attribution::is_on_purpose(n.op))
        return fmt::format("{}: the form goes to the next number on purpose, in {}. That {} {}",
                           blamed ? "No rounding is to blame" : "The largest contribution is not a rounding", what,
                           own_error(x, view), shares_text(x, view));
    return fmt::format("{}{} {}: its {} {}", amplifier_text(x, view),
                       blamed ? "The culprit is" : "The largest contribution is that of", what, own_error(x, view),
                       shares_text(x, view));
}

std::string counterfactual_sentence(const Explanation& x) {
    if (!x.culprit_alone || x.attribution.subject == no_node) return "";
    const OperationView view(x);
    const auto& [only_exact, only_rounded] = *x.culprit_alone;
    const NodeId culprit = x.attribution.culprit;
    const bool steps = measure::attribution::is_on_purpose(x.tape[culprit].op);
    const std::string what = view.text().operand(culprit), without = steps ? "Without" : "With",
                      exact = steps ? "" : " alone exact", rounded = steps ? " alone" : " alone rounded";
    if (x.attribution.subject != x.tape.outputs.t) {
        const auto decides = [](bool hit) { return hit ? "hits" : "misses"; };
        return fmt::format("{} {}{} the form {}{}; with {}{} it {}.", without, what, exact,
                           only_exact.hit == x.hit ? "still " : "", decides(only_exact.hit), what, rounded,
                           decides(only_rounded.hit));
    }
    const auto off = [&](std::string_view cause, const measure::attribution::Counterfactual& c) {
        if (!c.hit) return std::string("the form misses");
        return std::isfinite(c.error) ? fmt::format("{} puts t {:.4g} ulp off", cause, std::fabs(c.error / view.ulp()))
                                      : "t is not finite";
    };
    return fmt::format("{} {}{}, {}; with {}{}, {}.", without, what, exact, off("rounding", only_exact), what, rounded,
                       off("it", only_rounded));
}

}  // namespace lostbits::output::attribution
