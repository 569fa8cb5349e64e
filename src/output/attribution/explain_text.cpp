#include "output/attribution/explain_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "intersect/function/function.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/tape/contraction.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::attribution {

namespace {

/// Width of a text in characters, not in bytes.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string padded(std::string text, std::size_t width) {
    if (const auto w = width_of(text); w < width) text.append(width - w, ' ');
    return text;
}

/// Lines `  o.x = 0x1p+0  1`; last the ends of the ray's range, unless the range is the whole half-line.
std::string inputs_block(const Explanation& x) {
    std::string text, begin_line, end_line;
    std::size_t width = 0;
    for (const auto& name : x.input_names) width = std::max(width, name.size());
    const auto line = [&](std::size_t i, const char* suffix) {
        return fmt::format("  {:<{}} = {:<22} {}{}\n", x.input_names[i], width, file::hex(x.input_values[i]),
                           file::decimal(x.input_values[i]), suffix);
    };
    const auto end_kind = [](bool is_open) {
        return is_open ? " (open: a surface there does not count)" : " (closed)";
    };
    for (std::size_t i = 0; i < x.input_values.size(); ++i) {
        if (x.input_names[i] == "ray.tmin") begin_line = line(i, end_kind(x.range.open.tmin));
        else if (x.input_names[i] == "ray.tmax")
            end_line = line(i, std::isinf(x.input_values[i]) ? " (no end)" : end_kind(x.range.open.tmax));
        else text += line(i, "");
    }
    return x.range.is_whole() ? text : text + begin_line + end_line;
}

constexpr std::size_t widest_expression = 54;

/// Returns the mark, the name and the formula, `* c       = b·b`, padded to the first column of numbers. A formula
/// that is too wide gets a line of its own.
std::string name_and_formula(const char* mark, const OperationRow& operation_row) {
    std::string text = mark + padded(operation_row.name, 7) + " = " + operation_row.formula;
    if (width_of(text) > widest_expression) text += "\n" + std::string(widest_expression, ' ');
    return padded(std::move(text), widest_expression) + " ";
}

/// Width of the columns of values, whose widest header is "without rounding".
int number_width(const Explanation& x) { return std::max(digits_of(x.format.parameters) + 6, 16); }

std::string table_line(const Explanation& x, const OperationRow& operation_row) {
    const bool is_decision_row = operation_row.digits == 0;
    const char* const mark = operation_row.culprit ? "* " : operation_row.off_path ? "- " : "  ";
    const int width = number_width(x);
    const auto number = [&](double v) {
        if (is_decision_row) return fmt::format("{:>{}}", v != 0 ? "true" : "false", width);
        return fmt::format("{:>{}.{}g}", std::isnan(v) ? std::fabs(v) : v, std::max(width, operation_row.digits + 6),
                           operation_row.digits);
    };
    std::string line =
        name_and_formula(mark, operation_row) + number(operation_row.computed) + "  " + number(operation_row.exact);
    if (operation_row.shows_errors && !is_decision_row)
        line +=
            fmt::format("  {:>10}  {:<16}  {:>6}  {:>14}  {:>15}", operation_row.error_ulps, operation_row.cancelled,
                        operation_row.local, operation_row.rounding_ulps, operation_row.contribution_ulps);
    while (line.back() == ' ') line.pop_back();
    return line +
           (operation_row.branch_flipped ? "  rounding chose the other side"
            : operation_row.on_purpose   ? "  on purpose"
                                         : "") +
           "\n";
}

std::string table(const Explanation& x, const OperationView& view, bool show_all) {
    const int width = number_width(x);
    std::string text = padded("  operation", widest_expression) +
                       fmt::format(" {:>{}}  {:>{}}  {:>10}  {:<16}  {:>6}  {:>14}  {:>15}\n", "computed", width,
                                   "without rounding", width, "error, ulp", "bits cancelled", "local", "own error, ulp",
                                   fmt::format("share of {}, ulp", view.subject()));
    const OperationTable operations = operation_table(x, view, show_all);
    if (operations.first > 0)
        text += fmt::format("  ({} of earlier samples: --verbose)\n",
                            scene::toml::count_with_noun(operations.first, "operation"));
    for (const OperationRow& operation_row : operations.rows) text += table_line(x, operation_row);
    return text;
}

/// Collects the comparisons that determine decision `i`: of two operands, only those with the decision's exact value.
void add_deciding(const Explanation& x, const OperationView& view, NodeId i, std::vector<NodeId>& comparisons) {
    const TapeNode& n = x.tape[i];
    if (is_comparison(n.op)) {
        if (std::ranges::find(comparisons, i) == comparisons.end()) comparisons.push_back(i);
        return;
    }
    const auto holds = [&view](NodeId k) { return view.error_of(k).exact != 0; };
    for (const NodeId k : n.operands) {
        if (k == no_node || !is_decision(x.tape[k].op)) continue;
        if (n.operands[1] == no_node || holds(k) == holds(i)) add_deciding(x, view, k, comparisons);
    }
}

/// `disc < 1/1000 holds, where disc is 0.000147696701`: the comparison, and the exact value of each side that is not a
/// constant.
std::string comparison_text(const Explanation& x, const OperationView& view, NodeId i) {
    std::vector<std::string> sides;
    for (const NodeId side : x.tape[i].operands) {
        if (side != no_node && x.tape[side].op != TapeOp::constant && !view.text().is_number(side))
            sides.push_back(
                fmt::format("{} is {}", view.text().operand(side), number_phrase(view.error_of(side).exact)));
    }
    return fmt::format("{} {}, where {}", view.text().expression(i),
                       view.error_of(i).exact != 0 ? "holds" : "does not hold", fmt::join(sides, " and "));
}

/// The line of the user's file that contains an operation of a function, also of `FUNCTION+fma`; empty for other forms.
std::string source_line(const Explanation& x, NodeId node) {
    if (node == no_node) return "";
    if (!measure::tape::is_contracted(*x.form)) return intersect::function::quoted_line(*x.form->info, x.format, node);
    const measure::tape::FormOperation before = measure::tape::operation_before_contraction(*x.form, x.format, node);
    return intersect::function::quoted_line(*before.form->info, before.format, before.node);
}

/// The operation where a value that is not finite begins: a NaN from operands that are not NaN, or an infinity from
/// finite operands. `no_node` if it is an input.
NodeId begin_of_not_finite(const Explanation& x, const OperationView& view, NodeId i) {
    const auto exact = [&view](NodeId k) { return view.error_of(k).exact; };
    const bool is_nan = std::isnan(exact(i));
    const auto is_alike = [&](NodeId k) {
        return k != no_node && !is_decision(x.tape[k].op) && (is_nan ? std::isnan(exact(k)) : std::isinf(exact(k)));
    };
    for (;;) {
        if (is_given(x.tape[i].op)) return no_node;
        const NodeId side = measure::attribution::chosen_side(x.tape, i);
        const auto& operands = x.tape[i].operands;
        const NodeId* const next = std::ranges::find_if(operands, is_alike);
        if (is_alike(side)) i = side;
        else if (next != operands.end()) i = *next;
        else return i;
    }
}

/// Sentences on the compared values that are not finite, each with the operation where the value begins.
std::string not_finite_text(const Explanation& x, const OperationView& view, const std::vector<NodeId>& comparisons) {
    std::string text;
    std::vector<NodeId> named;
    for (const NodeId comparison : comparisons) {
        for (const NodeId side : x.tape[comparison].operands) {
            if (side == no_node || std::isfinite(view.error_of(side).exact)) continue;
            const NodeId begin = begin_of_not_finite(x, view, side);
            if (begin == no_node || std::ranges::find(named, begin) != named.end()) continue;
            named.push_back(begin);
            std::vector<std::string> values;
            for (const NodeId k : x.tape[begin].operands)
                if (k != no_node && x.tape[k].op != TapeOp::constant)
                    values.push_back(
                        fmt::format("{} is {}", view.text().operand(k), number_phrase(view.error_of(k).exact)));
            text += fmt::format("{} is {} because of {}{}{}.\n", view.text().operand(side),
                                number_phrase(view.error_of(side).exact), view.text().expression(begin),
                                values.empty() ? "" : ", where ", fmt::join(values, " and "));
            text += source_line(x, begin);
        }
    }
    return text;
}

std::string model_sentence(const Explanation& x, const OperationView& view) {
    if (x.missed_primitive) return "";  // the truth is about another primitive
    if (x.attribution.loop_was_cut_short)
        return "Without rounding the march would have gone on. The exact values shown end where the computed ones "
               "do.\n";
    const bool truly_hits = x.truth == measure::truth::Truth::Decision::hit;
    if (x.truth == measure::truth::Truth::Decision::unresolved || x.attribution.exact_hit == truly_hits) return "";
    std::string text = fmt::format(
        "On the inputs as the format stores them, the form {} even without rounding. It differs from the truth because "
        "of what it assumes{}.\n",
        x.attribution.exact_hit ? "hits" : "misses", x.rounded_inputs ? ", or because the inputs were rounded" : "");
    std::vector<NodeId> deciding;
    if (x.tape.outputs.hit != no_node) add_deciding(x, view, x.tape.outputs.hit, deciding);
    std::vector<std::string> comparison_texts;
    for (const NodeId i : deciding) comparison_texts.push_back(comparison_text(x, view, i));
    if (comparison_texts.empty()) return text;
    text += fmt::format("Without rounding {}.\n", fmt::join(comparison_texts, "; "));
    const std::string not_finite = not_finite_text(x, view, deciding);
    if (!not_finite.empty()) return text + not_finite;
    // The lines of a function's source, each once.
    std::vector<std::string> lines;
    for (const NodeId i : deciding) {
        const std::string line = source_line(x, i);
        if (!line.empty() && std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
    }
    return text + fmt::format("{}", fmt::join(lines, ""));
}

std::string sums_sentence(const Explanation& x, const OperationView& view) {
    const measure::attribution::Attribution& a = x.attribution;
    if (a.subject == no_node || !std::isfinite(a.error) || measure::attribution::is_plain_miss(x.tape, a)) return "";
    if (!std::isfinite(a.contribution_sum)) return "Some contributions are not finite, so they have no sum.\n";
    const double ulp = view.ulp(), unassigned = a.error - a.contribution_sum;
    std::string text = fmt::format(
        "Contributions sum to {} of {} ulp{}.", short_number(a.contribution_sum / ulp), short_number(a.error / ulp),
        std::fabs(unassigned) <= 1e-6 * std::fabs(a.error)
            ? ""
            : fmt::format("; {} ulp belong to no operation", short_number(unassigned / ulp)));
    if (!(std::fabs(a.first_order_sum - a.error) <= 0.1 * std::fabs(a.error))) {
        // Infinite terms of both signs have no sum.
        text += std::isfinite(a.first_order_sum)
                    ? fmt::format(" The last column uses difference quotients, because derivatives would give {} ulp.",
                                  short_number(a.first_order_sum / ulp))
                    : " The last column uses difference quotients, because derivatives are infinite on this ray.";
    }
    return text + "\n";
}

/// Sentence on the part of the error that is due to rounding.
std::string rounding_part_sentence(const Explanation& x, const OperationView& view) {
    if (x.result.outcome != Outcome::agree_hit || x.attribution.subject != x.tape.outputs.t) return "";
    if (culprit_operation(x) == no_node) return "";  // said in the verdict
    const double rounding = x.attribution.error / view.ulp();
    if (!std::isfinite(rounding) || !std::isfinite(x.result.ulps)) return "";
    if (!(std::fabs(x.result.ulps - rounding) > 0.01)) return "";
    return fmt::format(
        "Rounding inside the form causes {} of the {} ulp. The rest remains even without rounding, on the inputs as "
        "the format stores them.\n",
        short_number(rounding), short_number(x.result.ulps));
}

std::string changed_decisions_text(const Explanation& x, const OperationView& view) {
    std::string text;
    for (const NodeId i : x.changed_decisions()) {
        const TapeNode& n = x.tape[i];
        if (!is_comparison(n.op)) {
            const double distance = std::fabs(view.error_of(i).rounding);
            text +=
                fmt::format("Rounding changed the choice in {}: {}.\n", view.text().definition(i),
                            std::isfinite(distance) ? fmt::format("the other side is {} away", short_number(distance))
                                                    : "one of its sides is not finite");
            continue;
        }
        std::vector<std::string> sides;
        for (const NodeId side : {n.operands[0], n.operands[1]}) {
            if (x.tape[side].op == TapeOp::constant) continue;
            const std::string computed = number_phrase(x.tape[side].value),
                              exact = number_phrase(view.error_of(side).exact);
            sides.push_back(fmt::format("{} is {}{}", view.text().operand(side), computed,
                                        computed == exact ? "" : ", without rounding " + exact));
        }
        text +=
            fmt::format("Rounding changed the decision {}: {}.\n", view.text().expression(i), fmt::join(sides, "; "));
    }
    return text;
}

}  // namespace

std::string sums_text(const Explanation& x, const OperationView& view) {
    return sums_sentence(x, view) + rounding_part_sentence(x, view) + changed_decisions_text(x, view) +
           model_sentence(x, view);
}

namespace {

/// Phrase for what the envelope perturbs: the numbers of the problem as it is stored, before any step of the form.
std::string perturbation_phrase(const Explanation& x) {
    const bool is_placed = x.form->of(x.shape).is_placed;
    if (x.is_generated_ray) return "half an ulp in each number of the ideal ray and of the primitive";
    return is_placed ? "half an ulp in each number of ray, primitive and matrix as the world stores them"
                     : "half an ulp in each input";
}

std::string condition_phrase(double condition) {
    return std::isfinite(condition) ? fmt::format("Condition {}", short_number(condition))
                                    : "The condition is infinite";
}

bool another_does_better(const Explanation& x) {
    return std::ranges::any_of(x.better_forms, [&](const measure::attribution::FormResult& s) {
        return x.result.mean_lost_nearby - s.mean_lost_nearby >= worth_saying && s.lost_bits < x.result.lost_bits;
    });
}

/// Text for a loss within the envelope. The envelope does not bound other forms on the same exact numbers.
std::string within_envelope(const Explanation& x) {
    const bool is_placed = x.form->of(x.shape).is_placed;
    const char* const losing_part = is_placed            ? "transform and form lose"
                                    : x.is_generated_ray ? "making the ray and the form lose"
                                                         : "the formula loses";
    const char* const others_hint = another_does_better(x) ? " Other forms do better (see below)." : "";
    if (x.rounded_inputs && !x.is_generated_ray) return "; input rounding alone explains this loss.";
    if (x.is_generated_ray || x.form->info->direction == intersect::Direction::unit || !rounding_explains(x))
        return fmt::format("; {} no more than that.{}", losing_part, others_hint);
    return fmt::format(
        "; {} is ill-conditioned in {}, and {} no more. The inputs are exact: wider arithmetic on them helps.{}",
        is_placed ? "as the world stores it the problem" : "the problem", x.format.name, losing_part, others_hint);
}

}  // namespace

std::string envelope_sentence(const Explanation& x) {
    if (x.result.outcome == Outcome::agree_miss) return "Nothing is lost.";
    if (x.result.outcome != Outcome::agree_hit) {
        if (std::isnan(x.condition)) return "The ray hits nothing, so it has no condition number.";
        // The rest of the text is about the primitive that the form hits.
        const std::string where = x.missed_primitive ? fmt::format("At primitive {}: ", x.missed_primitive->index) : "";
        return fmt::format("{}{}: {} costs {:.1f} bits.", where, condition_phrase(x.condition), perturbation_phrase(x),
                           x.inherent_bits);
    }
    if (!x.returns_t()) return "The form returns no t, so it has no bits to lose.";
    const std::string envelope = fmt::format("{}: {} would cost {:.1f} bits", condition_phrase(x.condition),
                                             perturbation_phrase(x), x.inherent_bits);
    if (x.result.lost_bits < 1) return envelope + ". Less than one bit is lost.";
    if (x.excess_bits < 1) return envelope + within_envelope(x);
    if (x.inherent_bits >= x.format.parameters.precision)
        return envelope + fmt::format(", but cannot move t that far; the formula loses {:.1f} bits.", x.excess_bits);
    return envelope + fmt::format("; the formula loses the other {:.1f} bits.", x.excess_bits);
}

std::string explain_text(const Explanation& x, bool show_all, const std::optional<MarchEnd>& march) {
    std::string text = fmt::format("{} in {}: {}\n\n", x.form->info->name, x.format.name, x.form->info->title);
    text += verdict_of(x, march).text() + better_sentences(x) + "\n";
    // The line of a function's source is quoted for an operation that is not to blame, too, if its result is not
    // finite: the errors after it follow from there.
    NodeId culprit = x.has_tape() ? x.attribution.culprit : no_node;
    if (culprit != no_node && std::isfinite(x.tape[culprit].value)) culprit = culprit_operation(x);
    if (const std::string line = source_line(x, culprit); !line.empty()) text += line + "\n";
    if (x.primitive_count > 1 && is_primitive(x.form->shape))
        text += fmt::format("The scene has the primitives 0 to {}; this is primitive {}.\n", x.primitive_count - 1,
                            x.primitive_index);
    if (x.form->is_set())
        text +=
            fmt::format("It is a {}, which the form {} answers.\n", name_of(x.shape), x.form->of(x.shape).info->name);
    if (x.touching)
        text += fmt::format("Judged by the {} primitive: a ray that only touches is a {}.\n",
                            intersect::convention_name(x.touching),
                            *x.touching == intersect::Touching::hit ? "hit" : "miss");
    if (x.rounded_inputs) {
        text += fmt::format(
            "{} cannot represent all of these numbers and gets them rounded, as below. The true t is the one for the "
            "numbers as given, so the error includes the rounding of the inputs (input error).\n",
            x.format.name);
    }
    if (x.given_direction) {
        text += fmt::format(
            "The direction ({}, {}, {}) is normalised and rounded: the form takes unit directions, and its t is a "
            "distance.\n",
            number_phrase(x.given_direction->x), number_phrase(x.given_direction->y),
            number_phrase(x.given_direction->z));
    }
    text += inputs_block(x) + "\n";
    if (!x.has_tape()) return text;
    const OperationView view(x);
    if (march) text += march_samples(*march, x.format) + "\n";
    text += table(x, view, show_all) +
            fmt::format(
                "\n{}- marks operations that do not lead to the answer. Operations that only choose a branch have no "
                "share. catastrophic: an operand of the subtraction was already wrong; benign: both were exact. local: "
                "bits that the operation alone loses on exact operands, "
                "each rounded once. own: its rounding, in ulps of its own result. The last column assigns the error to "
                "operations: own times the difference quotient from there to the answer.\n",
                culprit_operation(x) != no_node ? "* marks the culprit, " : "");
    const std::string sums = sums_text(x, view);
    return text + (sums.empty() ? "" : "\n" + sums);
}

}  // namespace lostbits::output::attribution
