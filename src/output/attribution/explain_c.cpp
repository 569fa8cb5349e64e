// Writes an explained evaluation as a C program (see `explain_c`).
#include <fmt/format.h>

#include <cmath>

#include "measure/attribution/operations.hpp"
#include "measure/attribution/tape_text.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/attribution/tape_slice.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

namespace {

class CProgramWriter {
public:
    explicit CProgramWriter(const Explanation& explanation)
        : explanation_(explanation),
          text_(explanation.tape, explanation.input_names, measure::attribution::TapeText::TextStyle::plain),
          slice_(explanation.tape, {explanation.tape.outputs.t, explanation.tape.outputs.hit}),
          computes_in_double_(explanation.format.is_emulated()) {
        needs_remainders_ = computes_in_double_ && explanation.format.parameters.precision > 25;
    }

    std::string source() {
        std::string body;
        for (NodeId i = 0; i < explanation_.tape.size(); ++i) {
            if (slice_.is_needed(i)) body += statement(i);
        }
        return opening(body) + body + closing();
    }

private:
    [[nodiscard]] bool is_double(NodeId i) const {
        return computes_in_double_ || explanation_.tape.format_of(i) == binary64;
    }
    [[nodiscard]] std::string literal(double v, bool as_double) const {
        if (std::isnan(v)) return "NAN";
        if (std::isinf(v)) return v < 0 ? "-INFINITY" : "INFINITY";
        return file::hex(v) + (as_double ? "" : "f");
    }
    /// The name of a variable, or the digits of a value that depends only on constants.
    [[nodiscard]] std::string operand(NodeId i) const {
        if (!is_decision(explanation_.tape[i].op) && slice_.is_constant(i))
            return literal(explanation_.tape[i].value, is_double(i));
        return text_.identifier(i);
    }

    std::string statement(NodeId i) {
        const TapeNode& node = explanation_.tape[i];
        if (!is_decision(node.op) && slice_.is_constant(i)) return "";

        const std::string comment = node.op == TapeOp::input || (node.label.empty() && node.op != TapeOp::select)
                                        ? ""
                                        : fmt::format("  /* {}{} */", file::c_comment(text_.definition(i)),
                                                      node.op == TapeOp::call ? call_comment : "");
        const std::string type = is_decision(node.op) ? "int" : is_double(i) ? "volatile double" : "volatile float";
        return fmt::format("    {} {} = {};{}\n", type, text_.identifier(i), expression(i), comment);
    }

    std::string expression(NodeId i) {
        const TapeNode& node = explanation_.tape[i];
        if (node.op == TapeOp::input) return literal(node.value, is_double(i));
        const measure::attribution::OperationText& text = measure::attribution::text_of(node.op);
        if (computes_in_double_ && !text.missing_in_c.empty()) refuse(text.missing_in_c);
        const bool is_rounded = computes_in_double_ && !text.c_wide.empty();
        if (is_rounded && needs_remainders_) require_safe_remainder(i);

        const std::string value = measure::attribution::fill_pattern(
            is_rounded && needs_remainders_ ? text.c_wide : text.c.text,
            [&](std::size_t k, int) { return operand(node.operands[k]); },
            [&](char letter) -> std::string {
                if (letter == 'v') return literal(node.value, is_double(i));
                if (letter == 't') return is_double(i) ? "double" : "float";
                return is_double(i) ? "" : "f";
            });
        return is_rounded && !needs_remainders_ ? fmt::format("rounded({}, 0)", value) : value;
    }
    void refuse(std::string_view missing_feature) const {
        throw InputError(fmt::format("--c: {} uses {}, which C has only for float and double; try -f f32 or f64",
                                     explanation_.form->info->name, missing_feature));
    }

    /// Throws InputError unless the remainder of a sum, product, quotient or root is a double. It is one if no value
    /// comes near the ends of double's range (number/rounded.cpp).
    void require_safe_remainder(NodeId i) const {
        const TapeNode& node = explanation_.tape[i];
        bool is_exact = std::isnan(node.value), is_safe = true;  // zeros, infinities and NaN round to themselves
        const auto check_range = [&](double v) {
            is_safe = is_safe && std::fabs(v) >= 0x1p-960 && std::fabs(v) <= 0x1p+1000;
        };

        for (const NodeId operand_id : node.operands) {
            if (operand_id == no_node) continue;
            const double v = explanation_.tape[operand_id].value;
            is_exact = is_exact || v == 0 || !std::isfinite(v);
            if (node.op == TapeOp::div) check_range(v);
        }
        const bool is_sum = node.op == TapeOp::add || node.op == TapeOp::sub;
        if (is_sum) is_safe = std::fabs(node.value) <= 0x1p+1000;
        else check_range(node.value);

        if (is_exact || is_safe) return;
        throw InputError(
            fmt::format("--c: {} is {}, so close to the ends of double's range that its rounding error is not a "
                        "double, as {} bits need it; try -f f64, or a format of at most 25 bits",
                        text_.definition(i), file::decimal(node.value), explanation_.format.parameters.precision));
    }

    [[nodiscard]] std::string rounding_functions(const std::string& body) const {
        const FloatFormat& f = explanation_.format.parameters;
        std::string text = fmt::format(
            "/* r + rest, where r is the nearest double, rounded to {0} significand bits, exponents {1} to {2}, "
            "nearest even. "
            "*/\nstatic double rounded(double r, double rest) {{\n"
            "    int e;\n    double m, k;\n    if (r == 0 || isnan(r) || isinf(r)) return r;\n    frexp(r, &e);\n    e "
            "= (e - 1 > {1} ? e - 1 : {1}) - {0} + 1;\n"
            "    m = ldexp(fabs(r), -e);\n    k = floor(m);\n    if (r < 0) rest = -rest;\n    if (m - k > 0.5 || (m - "
            "k == 0.5 && (rest > 0 || (rest == 0 && fmod(k, 2) != 0)))) k += 1;\n"
            "    m = ldexp(k, e);\n    return copysign(m >= ldexp(1.0, {2}) * 2 ? INFINITY : m, r);\n}}\n",
            f.precision, f.emin, f.emax);

        // Operations whose rounding needs the sign of the double's remainder.
        const auto add_if_used = [&](const std::string& name, const std::string& function) {
            if (needs_remainders_ && body.find(" " + name + "(") != std::string::npos) text += function;
        };
        add_if_used("sum",
                    "static double sum(double a, double b) {\n    volatile double s = a + b, v = s - a, w = s - v, x = "
                    "a - w, y = b - v;\n"
                    "    return isfinite(s) ? rounded(s, x + y) : s;\n}\n");
        add_if_used("product",
                    "static double product(double a, double b) {\n    volatile double p = a * b;\n    return "
                    "rounded(p, fma(a, b, -p));\n}\n");
        add_if_used("quotient",
                    "static double quotient(double a, double b) {\n    volatile double q = a / b, rest = fma(-q, b, "
                    "a);\n    return rounded(q, b < 0 ? -rest : rest);\n}\n");
        add_if_used("root",
                    "static double root(double a) {\n    volatile double r = sqrt(a);\n    return rounded(r, fma(-r, "
                    "r, a));\n}\n");
        return text + "\n";
    }

    [[nodiscard]] std::string opening(const std::string& body) const {
        std::string text = fmt::format(
            "/* {} in {}: {}.\n   Source: {}. Compile with cc -lm; no fast math. */\n#include <math.h>\n#include "
            "<stdio.h>\n\n",
            explanation_.form->info->name, explanation_.format.name, file::c_comment(explanation_.form->info->title),
            file::c_comment(explanation_.form->info->source));
        if (computes_in_double_) text += rounding_functions(body);

        text +=
            "static void show(const char* what, int hit, double t) {\n    if (isnan(t)) printf(\"%-9s %s at nan\\n\", "
            "what, hit ? \"hit\" : \"miss\");\n"
            "    else printf(\"%-9s %s at %a = %.17g\\n\", what, hit ? \"hit\" : \"miss\", t, t);\n}\n"
            "static int is_same(double a, double b) { return isnan(a) ? isnan(b) : a == b && !signbit(a) == "
            "!signbit(b); }\n\n";
        return text + "int main(void) {\n";
    }

    /// One function of the program prints the computed, true and recorded t. The same bits therefore give the same
    /// text, however that machine's C library spells them.
    [[nodiscard]] std::string closing() const {
        const NodeId t = explanation_.tape.outputs.t, hit = explanation_.tape.outputs.hit;
        const std::string recorded = literal(explanation_.tape[t].value, true);
        std::string text = fmt::format("\n    show(\"computed\", {}, {});\n", text_.identifier(hit), operand(t));
        if (explanation_.truth == measure::truth::Truth::Decision::unresolved)
            text += "    puts(\"true      not proved\");\n";
        else
            text += explanation_.true_t
                        ? fmt::format("    show(\"true\", 1, {});\n", literal(*explanation_.true_t, true))
                        : "    puts(\"true      miss\");\n";
        text += fmt::format("    show(\"recorded\", {}, {});\n", explanation_.hit ? 1 : 0, recorded);
        return text + fmt::format("    return is_same({}, {}) && {}{} ? 0 : 1;\n}}\n", operand(t), recorded,
                                  explanation_.hit ? "" : "!", text_.identifier(hit));
    }

    static constexpr std::string_view call_comment = ": a call, which sums without rounding; this is its result";

    const Explanation& explanation_;
    TapeText text_;
    TapeSlice slice_;
    bool computes_in_double_, needs_remainders_ = false;
};

}  // namespace

std::string explain_c(const Explanation& explanation) { return CProgramWriter(explanation).source(); }

}  // namespace lostbits::output::attribution
