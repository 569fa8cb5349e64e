#include "output/attribution/explain_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "intersect/function/function.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::attribution {

namespace {

/// Number of letters, not of bytes.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string padded(std::string text, std::size_t width) {
    if (const auto w = width_of(text); w < width) text.append(width - w, ' ');
    return text;
}

/// `  o.x = 0x1p+0  1`, and last the range of the ray unless it is the whole half-line.
std::string inputs_block(const Explanation& x) {
    std::string text, begin, end;
    std::size_t width = 0;
    for (const auto& name : x.names) width = std::max(width, name.size());
    const auto line = [&](std::size_t i, const char* what) {
        return fmt::format("  {:<{}} = {:<22} {}{}\n", x.names[i], width, file::hex(x.inputs[i]),
                           file::decimal(x.inputs[i]), what);
    };
    const auto kind = [](bool open) { return open ? " (open: a surface there does not count)" : " (closed)"; };
    for (std::size_t i = 0; i < x.inputs.size(); ++i) {
        if (x.names[i] == "ray.tmin") begin = line(i, kind(x.range.open.tmin));
        else if (x.names[i] == "ray.tmax")
            end = line(i, std::isinf(x.inputs[i]) ? " (no end)" : kind(x.range.open.tmax));
        else text += line(i, "");
    }
    return x.range.is_whole() ? text : text + begin + end;
}

constexpr std::size_t widest_expression = 54;

/// `* c       = ` and the expression, as wide as the columns of numbers allow.
std::string left_of(const char* mark, const OperationRow& row) {
    std::string left = mark + padded(row.name, 7) + " = " + row.formula;
    if (width_of(left) > widest_expression) left += "\n" + std::string(widest_expression, ' ');
    return padded(std::move(left), widest_expression) + " ";
}

std::string line_of(const Explanation& x, const OperationRow& row) {
    const bool decides = row.digits == 0;
    const char* const mark = row.culprit ? "* " : row.off_path ? "- " : "  ";
    const int width = digits_of(x.format.parameters) + 6;
    const auto number = [&](double v) {
        if (decides) return fmt::format("{:>{}}", v != 0 ? "true" : "false", width);
        return fmt::format("{:>{}.{}g}", std::isnan(v) ? std::fabs(v) : v, std::max(width, row.digits + 6), row.digits);
    };
    std::string line = left_of(mark, row) + number(row.computed) + " " + number(row.exact);
    if (row.has_errors && !decides)
        line += fmt::format(" {:>10} {:<16} {:>6} {:>14} {:>15}", row.error_ulps, row.cancelled, row.local,
                            row.rounding_ulps, row.contribution_ulps);
    while (line.back() == ' ') line.pop_back();
    return line +
           (row.branch_flipped ? "  rounding chose the other side"
            : row.on_purpose   ? "  on purpose"
                               : "") +
           "\n";
}

std::string table(const Explanation& x, const OperationView& words, bool all) {
    const int width = digits_of(x.format.parameters) + 6;
    std::string text = padded("  operation", widest_expression) +
                       fmt::format(" {:>{}} {:>{}} {:>10} {:<16} {:>6} {:>14} {:>15}\n", "computed", width,
                                   "without rounding", width, "error, ulp", "bits cancelled", "local", "own error, ulp",
                                   fmt::format("share of {}, ulp", words.subject()));
    const OperationTable found = operation_table(x, words, all);
    if (found.first > 0)
        text += fmt::format("  ({} of earlier samples: --verbose)\n", scene::toml::counted(found.first, "operation"));
    for (const OperationRow& row : found.rows) text += line_of(x, row);
    return text;
}

/// The comparisons that determine a decision. If either of two is enough, only those that hold.
void add_deciding(const Explanation& x, const OperationView& words, NodeId i, std::vector<NodeId>& found) {
    const TapeNode& n = x.tape[i];
    if (is_comparison(n.op)) {
        if (std::ranges::find(found, i) == found.end()) found.push_back(i);
        return;
    }
    const auto holds = [&words](NodeId k) { return words.of(k).exact != 0; };
    for (const NodeId k : n.operands) {
        if (k == no_node || !is_decision(x.tape[k].op)) continue;
        if (n.operands[1] == no_node || holds(k) == holds(i)) add_deciding(x, words, k, found);
    }
}

/// `disc < 1/1000: disc is 0.000147696701, ...`: the comparison, and each side that is not a plain constant, without
/// rounding.
std::string comparison_text(const Explanation& x, const OperationView& words, NodeId i) {
    std::vector<std::string> sides;
    for (const NodeId s : x.tape[i].operands) {
        if (s != no_node && x.tape[s].op != TapeOp::constant)
            sides.push_back(fmt::format("{} is {}", words.text().operand(s), number_phrase(words.of(s).exact)));
    }
    return fmt::format("{} {}, where {}", words.text().expression(i),
                       words.of(i).exact != 0 ? "holds" : "does not hold", fmt::join(sides, " and "));
}

std::string model_sentence(const Explanation& x, const OperationView& words) {
    if (x.missed) return "";  // the truth is about another primitive
    if (x.attribution.cut_short)
        return "Without rounding the march would have gone on. The exact values shown end where the computed ones "
               "do.\n";
    const bool truly = x.truth == measure::truth::Truth::Decision::hit;
    if (x.truth == measure::truth::Truth::Decision::unresolved || x.attribution.exact_hit == truly) return "";
    std::string text = fmt::format(
        "On the inputs as the format stores them, the form {} even without rounding. It differs from the truth because "
        "of what it assumes{}.\n",
        x.attribution.exact_hit ? "hits" : "misses", x.rounded_inputs ? ", or because the inputs were rounded" : "");
    std::vector<NodeId> deciding;
    if (x.tape.outputs.hit != no_node) add_deciding(x, words, x.tape.outputs.hit, deciding);
    std::vector<std::string> told;
    for (const NodeId i : deciding) told.push_back(comparison_text(x, words, i));
    if (!told.empty()) text += fmt::format("Without rounding {}.\n", fmt::join(told, "; "));
    return text;
}

std::string sums_sentence(const Explanation& x, const OperationView& words) {
    const measure::attribution::Attribution& a = x.attribution;
    if (a.subject == no_node || !std::isfinite(a.error) || measure::attribution::is_plain_miss(x.tape, a)) return "";
    if (!std::isfinite(a.explained)) return "Some contributions are not finite, so they have no sum.\n";
    const double ulp = words.ulp(), rest = a.error - a.explained;
    std::string text = fmt::format("Contributions sum to {} of {} ulp{}.", short_number(a.explained / ulp),
                                   short_number(a.error / ulp),
                                   std::fabs(rest) <= 1e-6 * std::fabs(a.error)
                                       ? ""
                                       : fmt::format("; {} ulp belong to no operation", short_number(rest / ulp)));
    if (!(std::fabs(a.first_order - a.error) <= 0.1 * std::fabs(a.error))) {
        // Infinite terms of both signs have no sum.
        text += fmt::format(
            " A first-order estimate {} and is wrong here, so difference quotients are shown instead.",
            std::isfinite(a.first_order) ? "gives " + short_number(a.first_order / ulp) : "has infinite terms");
    }
    return text + "\n";
}

/// Sentence on the part of the error that is due to rounding.
std::string split_sentence(const Explanation& x, const OperationView& words) {
    if (x.result.outcome != Outcome::agree_hit || x.attribution.subject != x.tape.outputs.t) return "";
    if (culprit_operation(x) == no_node) return "";  // said in the verdict
    const double rounding = x.attribution.error / words.ulp();
    if (!std::isfinite(rounding) || !std::isfinite(x.result.ulps)) return "";
    if (!(std::fabs(x.result.ulps - rounding) > 0.01)) return "";
    return fmt::format(
        "Rounding inside the form causes {} of the {} ulp. The rest remains even without rounding, on the inputs as "
        "the format stores them.\n",
        short_number(rounding), short_number(x.result.ulps));
}

std::string turned_sentences(const Explanation& x, const OperationView& words) {
    std::string text;
    for (const NodeId i : x.turned()) {
        const TapeNode& n = x.tape[i];
        if (!is_comparison(n.op)) {
            const double away = std::fabs(words.of(i).rounding);
            text += fmt::format("Rounding changed the choice in {}: {}.\n", words.text().definition(i),
                                std::isfinite(away) ? fmt::format("the other side is {} away", short_number(away))
                                                    : "one of its sides is not finite");
            continue;
        }
        std::vector<std::string> sides;
        for (const NodeId s : {n.operands[0], n.operands[1]}) {
            if (x.tape[s].op == TapeOp::constant) continue;
            const std::string computed = number_phrase(x.tape[s].value), exact = number_phrase(words.of(s).exact);
            sides.push_back(fmt::format("{} is {}{}", words.text().operand(s), computed,
                                        computed == exact ? "" : ", without rounding " + exact));
        }
        text +=
            fmt::format("Rounding changed the decision {}: {}.\n", words.text().expression(i), fmt::join(sides, "; "));
    }
    return text;
}

}  // namespace

std::string sums_text(const Explanation& x, const OperationView& words) {
    return sums_sentence(x, words) + split_sentence(x, words) + turned_sentences(x, words) + model_sentence(x, words);
}

namespace {

/// The numbers that the envelope perturbs: those of the problem as it is stored, before any step of the form.
std::string each_input(const Explanation& x) {
    const bool placed = x.form->of(x.shape).is_placed;
    if (x.is_generated_ray) return "half an ulp in each number of the ideal ray and of the primitive";
    return placed ? "half an ulp in each number of ray, primitive and matrix as the world stores them"
                  : "half an ulp in each input";
}

std::string condition_phrase(double condition) {
    return std::isfinite(condition) ? fmt::format("Condition {}", short_number(condition))
                                    : "The condition is infinite";
}

bool another_does_better(const Explanation& x) {
    return std::ranges::any_of(x.better, [&](const measure::attribution::FormResult& s) {
        return x.result.lost_nearby - s.lost_nearby >= worth_saying && s.lost < x.result.lost;
    });
}

/// Text for a loss within the envelope. The envelope does not bound other forms on the same exact numbers.
std::string within_envelope(const Explanation& x) {
    const bool placed = x.form->of(x.shape).is_placed;
    const char* const who = placed               ? "transform and form lose"
                            : x.is_generated_ray ? "making the ray and the form lose"
                                                 : "the formula loses";
    const char* const others = another_does_better(x) ? " Other forms do better (see below)." : "";
    if (x.rounded_inputs && !x.is_generated_ray) return "; input rounding alone explains this loss.";
    if (x.is_generated_ray || x.form->info->direction == intersect::Direction::unit || !rounding_explains(x))
        return fmt::format("; {} no more than that.{}", who, others);
    return fmt::format(
        "; {} is ill-conditioned in {}, and {} no more. The inputs are exact: wider arithmetic on them helps.{}",
        placed ? "as the world stores it the problem" : "the problem", x.format.name, who, others);
}

}  // namespace

std::string envelope_sentence(const Explanation& x) {
    if (x.result.outcome == Outcome::agree_miss) return "Nothing is lost.";
    if (x.result.outcome != Outcome::agree_hit) {
        if (std::isnan(x.condition)) return "The ray hits nothing, so it has no condition number.";
        // The rest of the text is about the primitive that the form hits.
        const std::string where = x.missed ? fmt::format("At primitive {}: ", x.missed->primitive) : "";
        return fmt::format("{}{}: {} costs {:.1f} bits.", where, condition_phrase(x.condition), each_input(x),
                           x.inherent);
    }
    if (!x.tells_t()) return "The form returns no t, so it has no bits to lose.";
    const std::string envelope =
        fmt::format("{}: {} would cost {:.1f} bits", condition_phrase(x.condition), each_input(x), x.inherent);
    if (x.result.lost < 1) return envelope + ". Less than one bit is lost.";
    if (x.excess() < 1) return envelope + within_envelope(x);
    if (x.inherent >= x.format.parameters.precision)
        return envelope + fmt::format(", but cannot move t that far; the formula loses {:.1f} bits.", x.excess());
    return envelope + fmt::format("; the formula loses the other {:.1f} bits.", x.excess());
}

std::string explain_text(const Explanation& x, bool all, const std::optional<MarchEnd>& march) {
    std::string text = fmt::format("{} in {}: {}\n\n", x.form->info->name, x.format.name, x.form->info->title);
    text += verdict_of(x, march).text() + better_sentences(x) + "\n";
    // An operation that no one blames is quoted if its result is not a finite number: what follows comes from there.
    NodeId culprit = x.has_tape() ? x.attribution.culprit : no_node;
    if (culprit != no_node && std::isfinite(x.tape[culprit].value)) culprit = culprit_operation(x);
    if (const std::string line = intersect::function::quoted_line(*x.form->info, x.format, culprit); !line.empty())
        text += line + "\n";
    if (x.primitives > 1 && is_primitive(x.form->shape))
        text +=
            fmt::format("The scene has the primitives 0 to {}; this is primitive {}.\n", x.primitives - 1, x.primitive);
    if (x.form->is_set())
        text +=
            fmt::format("It is a {}, which the form {} answers.\n", name_of(x.shape), x.form->of(x.shape).info->name);
    if (x.judged)
        text +=
            fmt::format("Judged by the {} primitive: a ray that only touches is a {}.\n",
                        intersect::convention_name(x.judged), *x.judged == intersect::Touching::hit ? "hit" : "miss");
    if (x.rounded_inputs) {
        text += fmt::format(
            "{} cannot represent all of these numbers and gets them rounded, as below. The true t is the one for the "
            "numbers as given, so the error includes the rounding of the inputs (input error).\n",
            x.format.name);
    }
    if (x.given) {
        text += fmt::format(
            "The direction ({}, {}, {}) is normalised and rounded: the form takes unit directions, and its t is a "
            "distance.\n",
            number_phrase(x.given->x), number_phrase(x.given->y), number_phrase(x.given->z));
    }
    text += inputs_block(x) + "\n";
    if (!x.has_tape()) return text;
    const OperationView words(x);
    if (march) text += march_samples(*march, x.format) + "\n";
    text += table(x, words, all) +
            fmt::format(
                "\n{}- marks operations that do not lead to the answer. Operations that only choose a branch have no "
                "share. local: "
                "bits that the operation alone loses on exact operands, "
                "each rounded once. own: its rounding, in ulps of its own result. The last column assigns the error to "
                "operations: own times the difference quotient from there to the answer.\n",
                culprit_operation(x) != no_node ? "* marks the culprit, " : "");
    const std::string sums = sums_text(x, words);
    return text + (sums.empty() ? "" : "\n" + sums);
}

}  // namespace lostbits::output::attribution
