#include <fmt/format.h>

#include <cmath>

#include "measure/tape_text.hpp"
#include "number/error.hpp"
#include "output/explain_programs.hpp"
#include "output/number_text.hpp"
#include "output/tape_slice.hpp"

namespace lostbits::output {
namespace {

class Program {
public:
    explicit Program(const Explanation& x)
        : x_(x), text_(x.tape, x.names, TapeText::Style::plain), slice_(x.tape, {x.tape.outputs.t, x.tape.outputs.hit}), rounds_(x.format.engine == Format::Engine::rounded) {
        if (rounds_ && x.format.shape.precision > 25)
            throw InputError(fmt::format("--c: C has no type of {} bits, and computing in double and rounding differs from it; try -f f32, f64, or a format of at most 25 bits", x.format.shape.precision));
    }

    std::string written() {
        std::string body;
        for (NodeId i = 0; i < x_.tape.size(); ++i) {
            if (slice_.needs(i)) body += line(i);
        }
        return opening() + body + closing();
    }

private:
    [[nodiscard]] bool is_double(NodeId i) const { return rounds_ || x_.tape.format_of(i) == binary64; }
    [[nodiscard]] std::string literal(double v, bool as_double) const {
        if (std::isnan(v)) return "NAN";
        if (std::isinf(v)) return v < 0 ? "-INFINITY" : "INFINITY";
        return hex(v) + (as_double ? "" : "f");
    }
    /// A variable, or the digits of what depends on constants alone.
    [[nodiscard]] std::string operand(NodeId i) const {
        if (!is_decision(x_.tape[i].op) && slice_.is_constant(i)) return literal(x_.tape[i].value, is_double(i));
        return text_.identifier(i);
    }

    std::string line(NodeId i) {
        const TapeNode& n = x_.tape[i];
        if (!is_decision(n.op) && slice_.is_constant(i)) return "";
        const std::string comment = n.op == TapeOp::input || (n.label.empty() && n.op != TapeOp::select) ? "" : fmt::format("  /* {} */", text_.definition(i));
        const std::string type = is_decision(n.op) ? "int" : is_double(i) ? "volatile double" : "volatile float";
        return fmt::format("    {} {} = {};{}\n", type, text_.identifier(i), value(i), comment);
    }

    std::string value(NodeId i) {
        const TapeNode& n = x_.tape[i];
        if (n.op == TapeOp::input) return literal(n.value, is_double(i));
        const auto at = [&](std::size_t k) { return operand(n.operands[k]); };
        const auto infix = [&](const char* sign) { return fmt::format("{} {} {}", at(0), sign, at(1)); };
        const auto rounded = [&](const std::string& exact) { return rounds_ ? "rounded(" + exact + ")" : exact; };
        const char* const suffix = is_double(i) ? "" : "f";
        switch (n.op) {
            case TapeOp::add: return rounded(infix("+"));
            case TapeOp::sub: return rounded(infix("-"));
            case TapeOp::mul: return rounded(infix("*"));
            case TapeOp::div: return rounded(infix("/"));
            case TapeOp::sqrt: return rounded(fmt::format("sqrt{}({})", suffix, at(0)));
            case TapeOp::fma: refuse_rounded("a fused multiply-add"); return fmt::format("fma{}({}, {}, {})", suffix, at(0), at(1), at(2));
            case TapeOp::neg: return "-" + at(0);
            case TapeOp::abs: return fmt::format("fabs{}({})", suffix, at(0));
            case TapeOp::copysign: return fmt::format("copysign{}({}, {})", suffix, at(0), at(1));
            case TapeOp::min: return fmt::format("{0} < {1} ? {0} : {1}", at(0), at(1));
            case TapeOp::max: return fmt::format("{0} > {1} ? {0} : {1}", at(0), at(1));
            case TapeOp::select: return fmt::format("{} ? {} : {}", at(0), at(1), at(2));
            case TapeOp::next_up: refuse_rounded("a move to the next number"); return fmt::format("nextafter{}({}, INFINITY)", suffix, at(0));
            case TapeOp::next_down: refuse_rounded("a move to the next number"); return fmt::format("nextafter{}({}, -INFINITY)", suffix, at(0));
            case TapeOp::convert: return fmt::format("({}){}", is_double(i) ? "double" : "float", at(0));
            case TapeOp::less: return infix("<");
            case TapeOp::less_equal: return infix("<=");
            case TapeOp::greater: return infix(">");
            case TapeOp::greater_equal: return infix(">=");
            case TapeOp::both: return infix("&&");
            case TapeOp::either: return infix("||");
            case TapeOp::opposite: return "!" + at(0);
            default: return at(0);
        }
    }
    void refuse_rounded(const char* what) const {
        if (rounds_) throw InputError(fmt::format("--c: {} has {}, which C has for float and double alone; try -f f32 or f64", x_.form->info->name, what));
    }

    [[nodiscard]] std::string opening() const {
        std::string text = fmt::format("/* {} in {}: {}.\n   Source: {}. Compile with cc -lm; no fast math. */\n#include <math.h>\n#include <stdio.h>\n\n", x_.form->info->name, x_.format.name,
                                       x_.form->info->title, x_.form->info->source);
        if (rounds_) {
            const FloatFormat& f = x_.format.shape;
            text += fmt::format(
                "/* To {0} significand bits, exponents {1} to {2}, nearest even. */\nstatic double rounded(double x) {{\n    int e;\n    if (x == 0 || isnan(x) || isinf(x)) return x;\n"
                "    frexp(x, &e);\n    e = (e - 1 > {1} ? e - 1 : {1}) - {0} + 1;\n    x = ldexp(nearbyint(ldexp(x, -e)), e);\n    return fabs(x) >= ldexp(1.0, {2}) * 2 ? copysign(INFINITY, x) : x;\n}}\n\n",
                f.precision, f.emin, f.emax);
        }
        return text + "int main(void) {\n";
    }

    [[nodiscard]] std::string closing() const {
        const NodeId t = x_.tape.outputs.t, hit = x_.tape.outputs.hit;
        const double value = x_.tape[t].value;
        std::string text = fmt::format("\n    printf(\"computed  %s at %a = %.17g\\n\", {} ? \"hit\" : \"miss\", (double){}, (double){});\n", text_.identifier(hit), operand(t), operand(t));
        const std::string truth = x_.truth == Truth::Decision::unresolved ? "not proved" : x_.true_t ? fmt::format("hit at {} = {}", hex(*x_.true_t), decimal(*x_.true_t)) : "miss";
        text += fmt::format("    printf(\"true      {}\\n\");\n", truth);
        text += fmt::format("    printf(\"recorded  {} at {} = {}\\n\");\n", x_.hit ? "hit" : "miss", hex(value), decimal(value));
        const std::string same = std::isnan(value) ? fmt::format("isnan({})", operand(t)) : fmt::format("{} == {}", operand(t), literal(value, is_double(t)));
        return text + fmt::format("    return {} && {}{} ? 0 : 1;\n}}\n", same, x_.hit ? "" : "!", text_.identifier(hit));
    }

    const Explanation& x_;
    TapeText text_;
    TapeSlice slice_;
    bool rounds_;
};

}  // namespace

std::string explain_c(const Explanation& x) { return Program(x).written(); }

}  // namespace lostbits::output
