// Writes an explained evaluation as an FPCore benchmark (see `explain_fpcore`).
#include <fmt/format.h>

#include <cmath>

#include "measure/attribution/operations.hpp"
#include "measure/attribution/tape_text.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/attribution/tape_slice.hpp"

namespace lostbits::output::attribution {

namespace {

/// FPBench's names: `(float e n)` has e exponent bits and n bits in total.
std::string precision_name(const FloatFormat& format) {
    if (format == binary32) return "binary32";
    if (format == binary64) return "binary64";
    if (format == binary16) return "binary16";
    const int exponent_bits = 1 + std::ilogb(static_cast<double>(format.emax + 1));
    return fmt::format("(float {} {})", exponent_bits, exponent_bits + format.precision);
}

/// A double as an exact rational, built from integers of at most 53 bits and powers of two.
std::string rational_text(double x) {
    if (std::isnan(x)) return "NAN";
    if (std::isinf(x)) return x < 0 ? "(- INFINITY)" : "INFINITY";
    if (x == 0 || (x == std::floor(x) && std::fabs(x) < 0x1p53)) return fmt::format("{:.0f}", x);
    int e = 0;
    double k = std::frexp(x, &e);
    for (; k != std::floor(k); --e) k *= 2;
    if (e < 0 && e > -63) return fmt::format("{:.0f}/{}", k, std::uint64_t{1} << -e);
    return fmt::format("(* {:.0f} (pow 2 {}))", k, e);
}

class FpCoreWriter {
public:
    explicit FpCoreWriter(const Explanation& explanation)
        : explanation_(explanation),
          text_(explanation.tape, explanation.input_names, measure::attribution::TapeText::TextStyle::plain),
          slice_(explanation.tape, {explanation.tape.outputs.t}) {}

    std::string source() {
        const NodeId t = explanation_.tape.outputs.t;
        std::string body;
        for (NodeId i = 0; i < explanation_.tape.size(); ++i) {
            if (!slice_.is_needed(i) || !is_bound(i)) continue;
            const std::string value =
                is_decision(explanation_.tape[i].op) ? fmt::format("(if {} 1 0)", expression(i)) : typed_expression(i);
            body += fmt::format("    [{} {}]\n", text_.identifier(i), value);
        }
        return fmt::format(
            "(FPCore ({})\n  :name \"{} in {}, t\"\n  :precision {}\n  :cite (lostbits)\n  :pre {}\n  (let* (\n{}    "
            ")\n    {}))\n",
            arguments(), explanation_.form->info->name, explanation_.format.name,
            precision_name(explanation_.format.parameters), precondition(), body, operand(t));
    }

private:
    [[nodiscard]] bool is_input(NodeId i) const { return explanation_.tape[i].op == TapeOp::input; }
    /// True for values with a line of their own: every computed number, and decisions that are used more than once.
    [[nodiscard]] bool is_bound(NodeId i) const {
        if (is_input(i)) return false;
        if (is_decision(explanation_.tape[i].op)) return slice_.use_counts[i] > 1;
        return !slice_.is_constant(i);
    }
    [[nodiscard]] std::string operand(NodeId i) const {
        if (is_decision(explanation_.tape[i].op))
            return is_bound(i) ? fmt::format("(== {} 1)", text_.identifier(i)) : expression(i);
        return slice_.is_constant(i) ? rational_text(explanation_.tape[i].value) : text_.identifier(i);
    }
    [[nodiscard]] std::string expression(NodeId i) const {
        const TapeNode& node = explanation_.tape[i];
        if (node.op == TapeOp::call)
            throw InputError(fmt::format(
                "--fpcore: {} decides this ray by a call that sums without rounding, but FPCore has only operations "
                "of formats; --json and --c give the result of the call",
                explanation_.form->info->name));
        const FloatFormat& f = explanation_.tape.format_of(i);
        return measure::attribution::fill_pattern(
            measure::attribution::text_of(node.op).fpcore.text,
            [&](std::size_t k, int) { return operand(node.operands[k]); },
            [&](char) { return rational_text(std::ldexp(1.0, f.emin - f.precision + 1)); });
    }
    [[nodiscard]] std::string typed_expression(NodeId i) const {
        const std::string text = expression(i);
        const bool has_other_format = !(explanation_.tape.format_of(i) == explanation_.format.parameters);
        return has_other_format
                   ? fmt::format("(! :precision {} {})", precision_name(explanation_.tape.format_of(i)), text)
                   : text;
    }

    [[nodiscard]] std::string arguments() const {
        std::string text;
        for (NodeId i = 0; i < explanation_.tape.size(); ++i) {
            if (is_input(i) && slice_.is_needed(i)) text += (text.empty() ? "" : " ") + text_.identifier(i);
        }
        return text;
    }
    [[nodiscard]] std::string precondition() const {
        std::string text = "(and";
        for (NodeId i = 0; i < explanation_.tape.size(); ++i) {
            if (!is_input(i) || !slice_.is_needed(i)) continue;
            const double v = explanation_.tape[i].value, radius = std::fabs(v) * 0x1p-12;
            const std::string name = text_.identifier(i);
            if (v == 0 || !std::isfinite(v)) text += fmt::format("\n    (== {} {})", name, rational_text(v));
            else text += fmt::format("\n    (<= {} {} {})", rational_text(v - radius), name, rational_text(v + radius));
        }
        return text + ")";
    }

    const Explanation& explanation_;
    TapeText text_;
    TapeSlice slice_;
};

}  // namespace

std::string explain_fpcore(const Explanation& explanation) { return FpCoreWriter(explanation).source(); }

}  // namespace lostbits::output::attribution
