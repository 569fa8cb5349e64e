#include "output/blame/explain_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "output/blame/culprit_text.hpp"
#include "output/blame/operation_words.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::blame {

using measure::answer::Outcome;
using measure::blame::Explanation;
using measure::blame::OperationError;

namespace {

/// Letters, not bytes.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string padded(std::string text, std::size_t width) {
    if (const auto w = width_of(text); w < width) text.append(width - w, ' ');
    return text;
}

std::string inputs_block(const Explanation& x) {
    std::string text;
    std::size_t width = 0;
    for (const auto& name : x.names) width = std::max(width, name.size());
    for (std::size_t i = 0; i < x.inputs.size(); ++i) {
        if (x.names[i] == "limit" && std::isinf(x.inputs[i])) continue;
        text += fmt::format("  {:<{}} = {:<22} {}\n", x.names[i], width, file::hex(x.inputs[i]),
                            file::decimal(x.inputs[i]));
    }
    return text;
}

constexpr std::size_t widest_expression = 54;

std::string row_of(const Explanation& x, const OperationWords& words, NodeId i) {
    const OperationError& e = words.of(i);
    const int digits = 1 + static_cast<int>(std::ceil(x.tape.format_of(i).precision * 0.30103));
    const auto number = [digits](double v) {
        return fmt::format("{:>{}.{}g}", std::isnan(v) ? std::fabs(v) : v, digits + 6, digits);
    };
    const std::string mark = i == x.attribution.culprit ? "* " : e.live ? "  " : "- ";
    std::string name = words.text().name(i);
    std::string formula = words.text().expression(i);
    const std::string tail =
        fmt::format("{} {} {:>9} {:<16} {:>6} {:>9} {:>10}", number(x.tape[i].value), number(e.exact),
                    short_number(words.own_ulps(i, e.error)), words.cancellation(i),
                    e.local_bits == 0 ? "" : fmt::format("{:.1f}", e.local_bits),
                    e.rounding == 0 ? "" : short_number(words.own_ulps(i, e.rounding)),
                    e.live && e.rounding != 0 ? short_number(words.contribution(i)) : "");
    std::string left = mark + padded(std::move(name), 7) + " = " + formula;
    if (width_of(left) > widest_expression) left += "\n" + std::string(widest_expression, ' ');
    std::string line = padded(std::move(left), widest_expression) + " " + tail;
    while (line.back() == ' ') line.pop_back();
    return line + (e.turned && e.rounding != 0 ? "  rounding chose the other side" : "") + "\n";
}

/// The nodes that the table shows: of a march those of the last samples, unless all are asked for.
NodeId first_shown(const Explanation& x, bool all) {
    const auto& samples = x.tape.samples;
    return all || samples.size() < 3 ? 0 : static_cast<NodeId>(samples[samples.size() - 3]);
}

std::string table(const Explanation& x, const OperationWords& words, bool all) {
    const int digits = 1 + static_cast<int>(std::ceil(x.format.shape.precision * 0.30103));
    std::string text =
        padded("  operation", widest_expression) +
        fmt::format(" {:>{}} {:>{}} {:>9} {:<16} {:>6} {:>9} {:>10}\n", "computed", digits + 6, "without rounding",
                    digits + 6, "off, ulp", "bits cancelled", "local", "own, ulp", "of t, ulp");
    const NodeId from = first_shown(x, all);
    if (from > 0) text += fmt::format("  ({} operations of earlier samples: --verbose)\n", from);
    if (x.attribution.culprit != no_node && x.attribution.culprit < from)
        text += row_of(x, words, x.attribution.culprit);
    for (NodeId i = from; i < x.tape.size(); ++i) {
        if (words.is_shown(i, all)) text += row_of(x, words, i);
    }
    return text;
}

std::string outcome_sentence(const Explanation& x) {
    const std::string form(x.form->info->name);
    switch (x.standing.outcome) {
        case Outcome::agree_miss: return fmt::format("{} misses, and so does the exact ray: a correct miss.", form);
        case Outcome::false_hit:
            return fmt::format("{} reports a hit at {}, but the ray misses: a false hit.", form,
                               file::decimal(x.standing.t));
        case Outcome::false_miss:
            return fmt::format("{} reports a miss, but the ray hits at {}: a false miss.", form,
                               file::decimal(x.true_t.value_or(0)));
        case Outcome::not_a_number: return fmt::format("{} reports a hit at NaN.", form);
        case Outcome::unresolved: return "The true answer for this ray could not be proved.";
        case Outcome::wrong_object:
        case Outcome::agree_hit: break;
    }
    return fmt::format("t = {} ({}), the true t is {}: {:.4g} ulp off, {:.1f} of {} bits lost.",
                       file::decimal(x.standing.t), file::hex(x.standing.t), file::decimal(x.true_t.value_or(0)),
                       x.standing.ulps, x.standing.lost, x.format.shape.precision);
}

std::string model_sentence(const Explanation& x) {
    if (x.attribution.cut_short)
        return "Without rounding the march would have gone on. The exact values shown end where the computed ones "
               "do.\n";
    const bool truly = x.truth == measure::truth::Truth::Decision::hit;
    if (x.truth == measure::truth::Truth::Decision::unresolved || x.attribution.exact_hit == truly) return "";
    return fmt::format(
        "On the inputs as the format stores them, the form {} even without rounding. It differs from the truth because "
        "of what it assumes, or because the inputs were rounded.\n",
        x.attribution.exact_hit ? "hits" : "misses");
}

std::string sums_sentence(const Explanation& x, const OperationWords& words) {
    const measure::blame::Attribution& a = x.attribution;
    if (a.subject == no_node || !std::isfinite(a.error) || measure::blame::is_plain_miss(x.tape, a)) return "";
    const double ulp = words.ulp(), rest = a.error - a.explained;
    std::string text = fmt::format("Contributions sum to {} of {} ulp{}.", short_number(a.explained / ulp),
                                   short_number(a.error / ulp),
                                   std::fabs(rest) <= 1e-6 * std::fabs(a.error)
                                       ? ""
                                       : fmt::format("; {} ulp belong to no operation", short_number(rest / ulp)));
    if (!(std::fabs(a.first_order - a.error) <= 0.1 * std::fabs(a.error))) {
        // Infinite parts of both signs have no sum.
        text += fmt::format(
            " A first-order estimate {} and is wrong here, so difference quotients are shown instead.",
            std::isfinite(a.first_order) ? "gives " + short_number(a.first_order / ulp) : "has infinite terms");
    }
    return text + "\n";
}

/// How much of the error is rounding's at all.
std::string split_sentence(const Explanation& x, const OperationWords& words) {
    if (x.standing.outcome != Outcome::agree_hit || x.attribution.subject != x.tape.outputs.t) return "";
    const double rounding = x.attribution.error / words.ulp();
    if (!(std::fabs(x.standing.ulps - rounding) > 0.01)) return "";
    return fmt::format(
        "Rounding inside the form makes {} of the {} ulp. The rest is there even without it, on the inputs as the "
        "format stores them.\n",
        short_number(rounding), short_number(x.standing.ulps));
}

std::string turned_sentences(const Explanation& x, const OperationWords& words) {
    std::string text;
    for (const NodeId i : x.turned()) {
        const TapeNode& n = x.tape[i];
        if (!is_comparison(n.op)) {
            text += fmt::format("Rounding changed the choice in {}: the other side is {} away.\n",
                                words.text().definition(i), short_number(std::fabs(words.of(i).rounding)));
            continue;
        }
        std::vector<std::string> sides;
        for (const NodeId s : {n.operands[0], n.operands[1]}) {
            if (x.tape[s].op == TapeOp::constant) continue;
            sides.push_back(fmt::format("{} is {}, without rounding {}", words.text().operand(s),
                                        file::decimal(x.tape[s].value), file::decimal(words.of(s).exact)));
        }
        text +=
            fmt::format("Rounding changed the decision {}: {}.\n", words.text().expression(i), fmt::join(sides, "; "));
    }
    return text;
}

std::string better_sentence(const Explanation& x) {
    if (x.better.empty()) return "No other form of the same shape does better on this ray in this format.\n";
    std::string text = "Better on this ray:";
    constexpr std::size_t most = 6;
    for (std::size_t i = 0; i < std::min(most, x.better.size()); ++i) {
        const measure::blame::Standing& s = x.better[i];
        text +=
            fmt::format("{} {} ({})", i ? "," : "", s.form->info->name,
                        s.outcome == Outcome::agree_hit ? fmt::format("{:.1f} bits lost", s.lost) : "a correct miss");
    }
    return text + (x.better.size() > most ? fmt::format(" and {} more.\n", x.better.size() - most) : ".\n");
}

}  // namespace

std::string verdict(const Explanation& x) {
    if (x.standing.outcome != Outcome::agree_hit) {
        if (x.standing.outcome == Outcome::agree_miss) return "Nothing is lost.";
        return std::isnan(x.condition) ? "The ray hits nothing, so it has no condition number."
                                       : fmt::format("Condition {}: half an ulp in each input costs {:.1f} bits.",
                                                     short_number(x.condition), x.inherent);
    }
    const std::string envelope = fmt::format("Condition {}: half an ulp in each input would cost {:.1f} bits",
                                             short_number(x.condition), x.inherent);
    if (x.standing.lost < 1) return envelope + ". Less than one bit is lost.";
    if (x.excess() < 1) return envelope + "; input rounding alone explains this loss.";
    return envelope + fmt::format("; the formula loses the other {:.1f} bits.", x.excess());
}

std::string explain_text(const Explanation& x, bool all) {
    const OperationWords words(x);
    std::string text = fmt::format("{} in {}: {}\n", x.form->info->name, x.format.name, x.form->info->title);
    if (x.solids > 1 && x.form->shape != Shape::sdf) text += fmt::format("solid {} of {}\n", x.solid + 1, x.solids);
    if (x.judged)
        text +=
            fmt::format("Judged by {} solids: what a ray only touches is a {}.\n", intersect::convention_name(x.judged),
                        *x.judged == intersect::Touching::hit ? "hit" : "miss");
    if (x.rounded_inputs) {
        text += fmt::format(
            "{} cannot hold all of these numbers and gets them rounded, as below. The true t is that of the numbers as "
            "given, so the error includes what rounding them costs (input error).\n",
            x.format.name);
    }
    if (x.given) {
        text += fmt::format(
            "The direction ({}, {}, {}) is normalised and rounded: the form takes unit directions, and its t is a "
            "distance.\n",
            file::decimal(x.given->x), file::decimal(x.given->y), file::decimal(x.given->z));
    }
    text += inputs_block(x) + "\n" + table(x, words, all);
    text +=
        "\n* marks the culprit, - what is not on the way to the answer. local: bits that the operation alone loses on "
        "exact operands, each rounded once. own: its rounding, in ulps of its own result.\n\n";
    text += outcome_sentence(x) + "\n" + culprit_sentence(x) + "\n" + sums_sentence(x, words) +
            split_sentence(x, words) + turned_sentences(x, words) + model_sentence(x) + verdict(x) + "\n" +
            better_sentence(x);
    return text;
}

}  // namespace lostbits::output::blame
