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
#include "text/count_with_noun.hpp"

namespace lostbits::output::attribution {

namespace {

/// Width of a text in characters, not in bytes.
std::size_t character_count(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string pad_text(std::string text, std::size_t width) {
    if (const auto w = character_count(text); w < width) text.append(width - w, ' ');
    return text;
}

/// Lines of the inputs, such as `  o.x = 0x1p+0  1`. The ends of the ray's range come last; they are left out if the
/// range is the whole half-line.
std::string inputs_block(const Explanation& explanation) {
    std::string text, begin_line, end_line;
    std::size_t width = 0;
    for (const auto& name : explanation.input_names) width = std::max(width, name.size());
    const auto line = [&](std::size_t i, const char* suffix) {
        return fmt::format("  {:<{}} = {:<22} {}{}\n", explanation.input_names[i], width,
                           file::hex(explanation.input_values[i]), file::decimal(explanation.input_values[i]), suffix);
    };
    const auto end_kind = [](bool is_open) {
        return is_open ? " (open: a surface there does not count)" : " (closed)";
    };

    for (std::size_t i = 0; i < explanation.input_values.size(); ++i) {
        if (explanation.input_names[i] == "ray.tmin") begin_line = line(i, end_kind(explanation.range.open_ends.tmin));
        else if (explanation.input_names[i] == "ray.tmax")
            end_line = line(
                i, std::isinf(explanation.input_values[i]) ? " (no end)" : end_kind(explanation.range.open_ends.tmax));
        else text += line(i, "");
    }
    return explanation.range.is_whole() ? text : text + begin_line + end_line;
}

constexpr std::size_t widest_expression = 54;

/// Returns the mark, the name and the formula, `* c       = b·b`, pad to the first column of numbers. A formula
/// that is too wide gets a line of its own.
std::string name_and_formula_column(const char* mark, const OperationRow& operation_row) {
    std::string text = mark + pad_text(operation_row.name, 7) + " = " + operation_row.formula;
    if (character_count(text) > widest_expression) text += "\n" + std::string(widest_expression, ' ');
    return pad_text(std::move(text), widest_expression) + " ";
}

/// Width of the columns of values, whose widest header is "without rounding".
int number_column_width(const Explanation& explanation) {
    return std::max(digits_of(explanation.format.parameters) + 6, 16);
}

std::string table_line(const Explanation& explanation, const OperationRow& operation_row) {
    const bool is_decision_row = operation_row.digits == 0;
    const char* const mark = operation_row.is_culprit ? "* " : operation_row.is_off_path ? "- " : "  ";
    const int width = number_column_width(explanation);
    const auto number = [&](double v) {
        if (is_decision_row) return fmt::format("{:>{}}", v != 0 ? "true" : "false", width);
        return fmt::format("{:>{}.{}g}", std::isnan(v) ? std::fabs(v) : v, std::max(width, operation_row.digits + 6),
                           operation_row.digits);
    };

    std::string line = name_and_formula_column(mark, operation_row) + number(operation_row.computed) + "  " +
                       number(operation_row.exact);
    if (operation_row.shows_errors && !is_decision_row)
        line +=
            fmt::format("  {:>10}  {:<16}  {:>6}  {:>14}  {:>15}", operation_row.error_ulps, operation_row.cancelled,
                        operation_row.local_bits, operation_row.rounding_ulps, operation_row.contribution_ulps);

    while (line.back() == ' ') line.pop_back();
    return line +
           (operation_row.is_branch_flipped ? "  rounding chose the other side"
            : operation_row.is_on_purpose   ? "  on purpose"
                                            : "") +
           "\n";
}

std::string operation_table_text(const Explanation& explanation, const OperationView& view, bool show_all) {
    const int width = number_column_width(explanation);
    std::string text = pad_text("  operation", widest_expression) +
                       fmt::format(" {:>{}}  {:>{}}  {:>10}  {:<16}  {:>6}  {:>14}  {:>15}\n", "computed", width,
                                   "without rounding", width, "error, ulp", "bits cancelled", "local", "own error, ulp",
                                   fmt::format("share of {}, ulp", view.subject()));
    const OperationTable operations = operation_table(explanation, view, show_all);
    if (operations.first_node > 0)
        text += fmt::format("  ({} of earlier samples: --verbose)\n",
                            text::count_with_noun(operations.first_node, "operation"));
    for (const OperationRow& operation_row : operations.rows) text += table_line(explanation, operation_row);
    return text;
}

/// Collects the comparisons that determine decision `i`: of two operands, only those with the decision's exact value.
void collect_deciding_comparisons(const Explanation& explanation, const OperationView& view, NodeId i,
                                  std::vector<NodeId>& comparisons) {
    const TapeNode& node = explanation.tape[i];
    if (is_comparison(node.op)) {
        if (std::ranges::find(comparisons, i) == comparisons.end()) comparisons.push_back(i);
        return;
    }
    const auto is_exactly_true = [&view](NodeId k) { return view.error_of(k).exact != 0; };
    for (const NodeId k : node.operands) {
        if (k == no_node || !is_decision(explanation.tape[k].op)) continue;
        if (node.operands[1] == no_node || is_exactly_true(k) == is_exactly_true(i))
            collect_deciding_comparisons(explanation, view, k, comparisons);
    }
}

/// `disc < 1/1000 holds, where disc is 0.000147696701`: the comparison, and the exact value of each side that is not a
/// constant.
std::string comparison_text(const Explanation& explanation, const OperationView& view, NodeId i) {
    std::vector<std::string> sides;
    for (const NodeId side : explanation.tape[i].operands) {
        if (side != no_node && explanation.tape[side].op != TapeOp::constant && !view.text().is_number(side))
            sides.push_back(
                fmt::format("{} is {}", view.text().operand(side), number_phrase(view.error_of(side).exact)));
    }
    return fmt::format("{} {}, where {}", view.text().expression(i),
                       view.error_of(i).exact != 0 ? "holds" : "does not hold", fmt::join(sides, " and "));
}

/// The line of the user's file that contains an operation of a function or of its contraction `FUNCTION+fma`. Empty for
/// other forms.
std::string source_line(const Explanation& explanation, NodeId node) {
    if (node == no_node) return "";
    if (!measure::tape::is_contracted(*explanation.form))
        return intersect::function::quote_line(*explanation.form->info, explanation.format, node);
    const measure::tape::FormOperation before =
        measure::tape::find_operation_before_contraction(*explanation.form, explanation.format, node);
    return intersect::function::quote_line(*before.form->info, before.format, before.node);
}

/// The operation where a value that is not finite begins: a NaN from operands that are not NaN, or an infinity from
/// finite operands. `no_node` if it is an input.
NodeId origin_of_not_finite(const Explanation& explanation, const OperationView& view, NodeId i) {
    const auto exact = [&view](NodeId k) { return view.error_of(k).exact; };
    const bool is_nan = std::isnan(exact(i));
    const auto is_alike = [&](NodeId k) {
        return k != no_node && !is_decision(explanation.tape[k].op) &&
               (is_nan ? std::isnan(exact(k)) : std::isinf(exact(k)));
    };

    // Goes from operand to operand while one has the same kind of value.
    for (;;) {
        if (is_given(explanation.tape[i].op)) return no_node;
        const NodeId side = measure::attribution::chosen_side(explanation.tape, i);
        const auto& operands = explanation.tape[i].operands;
        const NodeId* const next = std::ranges::find_if(operands, is_alike);
        if (is_alike(side)) i = side;
        else if (next != operands.end()) i = *next;
        else return i;
    }
}

/// `b is 3`, for each operand of an operation that is not a constant, with its exact value.
std::vector<std::string> exact_operand_texts(const Explanation& explanation, const OperationView& view, NodeId i) {
    std::vector<std::string> texts;
    for (const NodeId k : explanation.tape[i].operands)
        if (k != no_node && explanation.tape[k].op != TapeOp::constant)
            texts.push_back(fmt::format("{} is {}", view.text().operand(k), number_phrase(view.error_of(k).exact)));
    return texts;
}

/// Sentences on the compared values that are not finite, each with the operation where the value begins.
std::string not_finite_text(const Explanation& explanation, const OperationView& view,
                            const std::vector<NodeId>& comparisons) {
    std::string text;
    std::vector<NodeId> named_origins;
    for (const NodeId comparison : comparisons) {
        for (const NodeId side : explanation.tape[comparison].operands) {
            if (side == no_node || std::isfinite(view.error_of(side).exact)) continue;
            const NodeId origin = origin_of_not_finite(explanation, view, side);
            if (origin == no_node || std::ranges::find(named_origins, origin) != named_origins.end()) continue;
            named_origins.push_back(origin);

            const std::vector<std::string> values = exact_operand_texts(explanation, view, origin);
            text += fmt::format("{} is {} because of {}{}{}.\n", view.text().operand(side),
                                number_phrase(view.error_of(side).exact), view.text().expression(origin),
                                values.empty() ? "" : ", where ", fmt::join(values, " and "));
            text += source_line(explanation, origin);
        }
    }
    return text;
}

/// Sentences on the comparisons that decide the form's answer without rounding, and on their values that are not
/// finite. If all are finite: the lines of the form's source.
std::string deciding_comparisons_text(const Explanation& explanation, const OperationView& view) {
    if (explanation.tape.outputs.hit == no_node) return "";
    std::vector<NodeId> deciding;
    collect_deciding_comparisons(explanation, view, explanation.tape.outputs.hit, deciding);
    if (deciding.empty()) return "";

    std::vector<std::string> comparison_texts;
    for (const NodeId i : deciding) comparison_texts.push_back(comparison_text(explanation, view, i));
    const std::string text = fmt::format("Without rounding {}.\n", fmt::join(comparison_texts, "; "));
    const std::string not_finite = not_finite_text(explanation, view, deciding);
    if (!not_finite.empty()) return text + not_finite;

    // The lines of a function's source, each once.
    std::vector<std::string> lines;
    for (const NodeId i : deciding) {
        const std::string line = source_line(explanation, i);
        if (!line.empty() && std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
    }
    return text + fmt::format("{}", fmt::join(lines, ""));
}

/// Sentences on a decision that differs from the truth even without rounding. Empty if it does not.
std::string model_text(const Explanation& explanation, const OperationView& view) {
    if (explanation.missed_primitive) return "";  // the truth is about another primitive
    if (explanation.attribution.loop_was_cut_short)
        return "Without rounding the march would have gone on. The exact values shown end where the computed ones "
               "do.\n";

    const bool truly_hits = explanation.truth == measure::truth::Truth::Decision::hit;
    if (explanation.truth == measure::truth::Truth::Decision::unresolved ||
        explanation.attribution.is_exact_hit == truly_hits)
        return "";
    return fmt::format(
               "On the inputs as the format stores them, the form {} even without rounding. It differs from the truth "
               "because of what it assumes{}.\n",
               explanation.attribution.is_exact_hit ? "hits" : "misses",
               explanation.has_rounded_inputs ? ", or because the inputs were rounded" : "") +
           deciding_comparisons_text(explanation, view);
}

std::string sums_sentence(const Explanation& explanation, const OperationView& view) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    if (attribution.subject == no_node || !std::isfinite(attribution.error) ||
        measure::attribution::is_plain_miss(explanation.tape, attribution))
        return "";
    if (!std::isfinite(attribution.contribution_sum))
        return "Some contributions are not finite, so they have no sum.\n";

    const double ulp = view.ulp(), unassigned = attribution.error - attribution.contribution_sum;
    std::string text =
        fmt::format("The contributions add up to {} of the {} ulp{}.", short_number(attribution.contribution_sum / ulp),
                    short_number(attribution.error / ulp),
                    std::fabs(unassigned) <= 1e-6 * std::fabs(attribution.error)
                        ? ""
                        : fmt::format("; {} ulp belong to no operation", short_number(unassigned / ulp)));

    if (!(std::fabs(attribution.first_order_sum - attribution.error) <= 0.1 * std::fabs(attribution.error))) {
        // Infinite terms of both signs have no sum.
        text += std::isfinite(attribution.first_order_sum)
                    ? fmt::format(" The last column uses difference quotients, because derivatives would give {} ulp.",
                                  short_number(attribution.first_order_sum / ulp))
                    : " The last column uses difference quotients, because derivatives are infinite on this ray.";
    }
    return text + "\n";
}

/// Sentence on the part of the error that is due to rounding.
std::string rounding_part_sentence(const Explanation& explanation, const OperationView& view) {
    if (explanation.result.outcome != Outcome::agree_hit ||
        explanation.attribution.subject != explanation.tape.outputs.t)
        return "";
    if (culprit_operation(explanation) == no_node && explanation.result.lost_bits >= min_notable_bits)
        return "";  // said in the verdict
    const double rounding = explanation.attribution.error / view.ulp();
    if (!std::isfinite(rounding) || !std::isfinite(explanation.result.ulps)) return "";
    if (!(std::fabs(explanation.result.ulps - rounding) > 0.01)) return "";
    return fmt::format(
        "The error of t has two parts: {} ulp from rounding inside the form, and {} ulp that remain even without "
        "rounding, on the inputs as the format stores them.\n",
        short_number(rounding), short_number(explanation.result.ulps - rounding));
}

std::string changed_decisions_text(const Explanation& explanation, const OperationView& view) {
    std::string text;
    for (const NodeId i : explanation.find_changed_decisions()) {
        const TapeNode& node = explanation.tape[i];
        if (!is_comparison(node.op)) {
            const double distance = std::fabs(view.error_of(i).rounding);
            text +=
                fmt::format("Rounding changed the choice in {}: {}.\n", view.text().definition(i),
                            std::isfinite(distance) ? fmt::format("the other side is {} away", short_number(distance))
                                                    : "one of its sides is not finite");
            continue;
        }
        std::vector<std::string> sides;
        for (const NodeId side : {node.operands[0], node.operands[1]}) {
            if (explanation.tape[side].op == TapeOp::constant) continue;
            const std::string computed = number_phrase(explanation.tape[side].value),
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

std::string sums_text(const Explanation& explanation, const OperationView& view) {
    return sums_sentence(explanation, view) + rounding_part_sentence(explanation, view) +
           changed_decisions_text(explanation, view) + model_text(explanation, view);
}

namespace {

/// Phrase for what the envelope perturbs: the numbers of the problem as it is stored, before any step of the form.
std::string perturbation_phrase(const Explanation& explanation) {
    const bool has_transform_method = explanation.form->form_for(explanation.shape).has_transform_method;
    if (explanation.is_generated_ray) return "half an ulp in each number of the ideal ray and of the primitive";
    return has_transform_method ? "half an ulp in each number of ray, primitive and matrix as the world stores them"
                                : "half an ulp in each input";
}

std::string condition_phrase(double condition) {
    return std::isfinite(condition) ? fmt::format("Condition {}", short_number(condition))
                                    : "The condition is infinite";
}

bool does_another_form_better(const Explanation& explanation) {
    return std::ranges::any_of(explanation.better_forms, [&](const measure::attribution::FormResult& s) {
        return explanation.result.mean_lost_nearby - s.mean_lost_nearby >= min_notable_bits &&
               s.lost_bits < explanation.result.lost_bits;
    });
}

/// Text for a loss within the envelope. The envelope does not bound other forms on the same exact numbers.
std::string within_envelope_text(const Explanation& explanation) {
    const bool has_transform_method = explanation.form->form_for(explanation.shape).has_transform_method;
    const char* const losing_part = has_transform_method           ? "transform and form lose"
                                    : explanation.is_generated_ray ? "making the ray and the form lose"
                                                                   : "the formula loses";
    const char* const others_hint = does_another_form_better(explanation) ? " Other forms do better (see below)." : "";
    if (explanation.has_rounded_inputs && !explanation.is_generated_ray)
        return "; input rounding alone explains this loss.";
    if (explanation.is_generated_ray || explanation.form->info->direction == intersect::Direction::unit ||
        !rounding_explains(explanation))
        return fmt::format("; {} no more than that.{}", losing_part, others_hint);
    return fmt::format(
        "; {} is ill-conditioned in {}, and {} no more. The inputs are exact: wider arithmetic on them helps.{}",
        has_transform_method ? "as the world stores it the problem" : "the problem", explanation.format.name,
        losing_part, others_hint);
}

}  // namespace

std::string envelope_sentence(const Explanation& explanation) {
    // Without an agreed hit there are no lost bits, only those that the problem itself costs.
    if (explanation.result.outcome == Outcome::agree_miss) return "Nothing is lost.";
    if (explanation.result.outcome != Outcome::agree_hit) {
        if (std::isnan(explanation.condition)) return "The ray hits nothing, so it has no condition number.";
        // The rest of the text is about the primitive that the form hits.
        const std::string where =
            explanation.missed_primitive ? fmt::format("At primitive {}: ", explanation.missed_primitive->index) : "";
        return fmt::format("{}{}: {} costs {:.1f} bits.", where, condition_phrase(explanation.condition),
                           perturbation_phrase(explanation), explanation.inherent_bits);
    }
    if (!explanation.returns_t()) return "The form returns no t, so it has no bits to lose.";

    const std::string envelope = fmt::format("{}: {} would cost {:.1f} bits", condition_phrase(explanation.condition),
                                             perturbation_phrase(explanation), explanation.inherent_bits);
    if (explanation.result.lost_bits < 1) return envelope + ". Less than one bit is lost.";
    if (explanation.excess_bits < 1) return envelope + within_envelope_text(explanation);
    if (explanation.inherent_bits >= explanation.format.parameters.precision)
        return envelope +
               fmt::format(", but cannot move t that far; the formula loses {:.1f} bits.", explanation.excess_bits);
    return envelope + fmt::format("; the formula loses the other {:.1f} bits.", explanation.excess_bits);
}

namespace {

/// Sentences on the primitive that the ray is explained for, the form that answers it, and the convention.
std::string subject_notes(const Explanation& explanation) {
    std::string text;
    if (explanation.primitive_count > 1 && is_primitive(explanation.form->shape))
        text += fmt::format("The scene has the primitives 0 to {}; this is primitive {}.\n",
                            explanation.primitive_count - 1, explanation.primitive_index);
    if (explanation.form->is_set())
        text += fmt::format("It is a {}, which the form {} answers.\n", name_of(explanation.shape),
                            explanation.form->form_for(explanation.shape).info->name);
    if (explanation.touching)
        text += fmt::format("Judged by the {} primitive: a ray that only touches is a {}.\n",
                            intersect::convention_name(explanation.touching),
                            *explanation.touching == intersect::Touching::hit ? "hit" : "miss");
    return text;
}

/// Sentences on inputs that the form does not get as they were given.
std::string input_notes(const Explanation& explanation) {
    std::string text;
    if (explanation.has_rounded_inputs)
        text += fmt::format(
            "{} cannot represent all of these numbers and gets them rounded, as below. The true t is the one for the "
            "numbers as given, so the error includes the rounding of the inputs (input error).\n",
            explanation.format.name);
    if (explanation.given_direction)
        text += fmt::format(
            "The direction ({}, {}, {}) is normalised and rounded: the form takes unit directions, and its t is a "
            "distance.\n",
            number_phrase(explanation.given_direction->x), number_phrase(explanation.given_direction->y),
            number_phrase(explanation.given_direction->z));
    return text;
}

/// Meanings of the marks and columns of the table of operations.
std::string table_legend(const Explanation& explanation) {
    return fmt::format(
        "{}- marks operations that do not lead to the answer.\n"
        "bits cancelled: catastrophic if an operand of the subtraction was already wrong, benign if both were exact.\n"
        "local: bits that the operation alone loses on exact operands, each rounded once.\n"
        "own error: the rounding of the operation, in ulps of its result.\n"
        "share: the part of the answer's error that this rounding causes: the own error times the difference quotient "
        "of the answer by the operation. Operations that only choose a branch have no share.\n",
        culprit_operation(explanation) != no_node ? "* marks the culprit, " : "");
}

}  // namespace

std::string explain_text(const Explanation& explanation, bool show_all, const std::optional<MarchEnd>& march) {
    std::string text = fmt::format("{} in {}: {}\n\n", explanation.form->info->name, explanation.format.name,
                                   explanation.form->info->title);
    text += make_verdict(explanation, march).text() + better_forms_text(explanation) + "\n";

    // The source line is also quoted for an operation that is not to blame if its result is not finite, because the
    // errors after it follow from that.
    NodeId culprit = explanation.has_tape() ? explanation.attribution.culprit : no_node;
    if (culprit != no_node && std::isfinite(explanation.tape[culprit].value)) culprit = culprit_operation(explanation);
    if (const std::string line = source_line(explanation, culprit); !line.empty()) text += line + "\n";

    text += subject_notes(explanation) + input_notes(explanation) + inputs_block(explanation) + "\n";
    if (!explanation.has_tape()) return text;

    const OperationView view(explanation);
    if (march) text += march_samples(*march, explanation.format) + "\n";
    text += operation_table_text(explanation, view, show_all) + "\n" + table_legend(explanation);
    const std::string sums = sums_text(explanation, view);
    return text + (sums.empty() ? "" : "\n" + sums);
}

}  // namespace lostbits::output::attribution
