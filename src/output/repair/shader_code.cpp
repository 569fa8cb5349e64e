#include "output/repair/form_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <sstream>

#include "measure/attribution/operations.hpp"
#include "number/error.hpp"
#include "output/file/escape.hpp"
#include "output/repair/tape_code.hpp"

namespace lostbits::output::repair {

namespace {

/// A function that the shader may call. In `helpers`, a helper stands after those that it calls.
struct Helper {
    std::string_view name, text;
};

/// The operations of `number::wide::TwoWords` on floats; x is the high word. `fused` is Boldo and Melquiond's fma
/// ("Emulation of a FMA and correctly rounded sums: proved algorithms using rounding to odd", 2008), which is correct
/// to the last bit if nothing underflows and no product exceeds 2^115.
constexpr std::array helpers{
    Helper{"least", R"(float least(float a, float b) {
    precise float x = a < b ? a : b;
    return x;
}
)"},
    Helper{"most", R"(float most(float a, float b) {
    precise float x = a > b ? a : b;
    return x;
}
)"},
    Helper{"least_of_doubles", R"(double least_of_doubles(double a, double b) {
    precise double x = a < b ? a : b;
    return x;
}
)"},
    Helper{"most_of_doubles", R"(double most_of_doubles(double a, double b) {
    precise double x = a > b ? a : b;
    return x;
}
)"},
    Helper{"with_sign", R"(float with_sign(float a, float b) {
    return uintBitsToFloat((floatBitsToUint(a) & 0x7fffffffu) | (floatBitsToUint(b) & 0x80000000u));
}
)"},
    Helper{"sum_of", R"(vec2 sum_of(float a, float b) {  // a + b, exactly (Knuth)
    precise float s = a + b;
    precise float t = s - a;
    precise float lost = (a - (s - t)) + (b - t);
    return vec2(s, lost);
}
)"},
    Helper{"ordered_sum", R"(vec2 ordered_sum(float a, float b) {  // the same where |a| >= |b| (Dekker)
    precise float s = a + b;
    precise float lost = b - (s - a);
    return vec2(s, lost);
}
)"},
    Helper{"product_of", R"(vec2 product_of(float a, float b) {  // a b, exactly (Dekker)
    precise float p = a * b;
    precise float ka = 4097.0 * a;
    precise float kb = 4097.0 * b;
    precise float ah = ka - (ka - a);
    precise float bh = kb - (kb - b);
    precise float al = a - ah;
    precise float bl = b - bh;
    precise float lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return vec2(p, lost);
}
)"},
    Helper{"fused", R"(float fused(float a, float b, float c) {  // a b + c, rounded once (Boldo and Melquiond)
    vec2 p = product_of(a, b);
    vec2 t = sum_of(c, p.y);
    vec2 v = sum_of(p.x, t.x);
    vec2 z = sum_of(t.y, v.y);
    uint odd = floatBitsToUint(z.x);
    if (z.y != 0.0 && (odd & 1u) == 0u) odd += (z.y > 0.0) == (z.x > 0.0) ? 1u : 0xffffffffu;
    precise float x = v.x + uintBitsToFloat(odd);
    return x;
}
)"},
    Helper{"plus", R"(vec2 plus(vec2 a, vec2 b) {
    vec2 s = sum_of(a.x, b.x);
    vec2 t = sum_of(a.y, b.y);
    precise float small = s.y + t.x;
    vec2 v = ordered_sum(s.x, small);
    precise float smaller = t.y + v.y;
    return ordered_sum(v.x, smaller);
}
)"},
    Helper{"times", R"(vec2 times(vec2 a, vec2 b) {
    vec2 p = product_of(a.x, b.x);
    precise float other = a.y * b.x;
    precise float small = p.y + fused(a.x, b.y, other);
    return ordered_sum(p.x, small);
}
)"},
    Helper{"over", R"(vec2 over(vec2 a, vec2 b) {
    precise float q = a.x / b.x;
    precise float rest = fused(-q, b.x, a.x);
    precise float small = (rest + (a.y - q * b.y)) / b.x;
    return ordered_sum(q, small);
}
)"},
    Helper{"root", R"(vec2 root(vec2 a) {
    precise float s = sqrt(a.x);
    precise float rest = fused(-s, s, a.x);
    precise float small = (a.y + rest) / (2.0 * s);
    return ordered_sum(s, small);
}
)"},
    Helper{"below", R"(bool below(vec2 a, vec2 b) {
    return a.x < b.x || (!(b.x < a.x) && a.y < b.y);
}
)"},
    Helper{"not_above", R"(bool not_above(vec2 a, vec2 b) {
    return a.x < b.x || (a.x <= b.x && a.y <= b.y);
}
)"},
    Helper{"size_of", R"(vec2 size_of(vec2 a) {
    return a.x < 0.0 ? -a : a;
}
)"},
};

/// Names that the code must not use: keywords of GLSL that labels might be, parameters, and called functions.
std::set<std::string, std::less<>> reserved_names_of_glsl(const ShapeRow& shape) {
    std::set<std::string, std::less<>> reserved{
        "o",      "d",      "tmax",    "first",     "abs",      "sqrt",   "and",    "or",     "not",    "half",
        "input",  "output", "sample",  "fixed",     "filter",   "active", "common", "smooth", "flat",   "in",
        "out",    "inout",  "this",    "using",     "volatile", "int",    "uint",   "bool",   "true",   "false",
        "float",  "double", "precise", "invariant", "buffer",   "shared", "static", "extern", "return", "discard",
        "switch", "for",    "while",   "if",        "else",     "do",     "long",   "short",  "const",  "uniform"};
    for (const Helper& helper : helpers) reserved.emplace(helper.name);
    for (const Key& key : shape.keys) reserved.emplace(key.name);
    return reserved;
}

/// Name of the function, made from the name of its file. GLSL reserves its keywords and functions, names that begin
/// with gl_, and names with two adjacent underscores. The program around a shader reserves names that begin with lb_.
/// Such names are changed: adjacent underscores become one, and the others get an underscore or a prefix.
std::string function_name(const std::string& file, const ShapeRow& shape) {
    static const std::set<std::string, std::less<>> glsl_words = [] {
        std::istringstream words(R"(
            main void attribute varying centroid patch layout break continue case default subroutine struct lowp
            mediump highp precision coherent readonly writeonly restrict atomic_uint asm class union enum typedef
            template goto inline noinline public external interface unsigned superp namespace cast sizeof hvec2
            hvec3 hvec4 fvec2 fvec3 fvec4 mat2 mat3 mat4 vec2 vec3 vec4 dvec2 dvec3 dvec4 ivec2 ivec3 ivec4 uvec2
            uvec3 uvec4 bvec2 bvec3 bvec4 sampler1D sampler2D sampler3D samplerCube radians degrees sin cos tan asin
            acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2 log2 inversesqrt sign floor trunc round
            roundEven ceil fract mod modf min max clamp mix step smoothstep isnan isinf fma frexp ldexp length
            distance dot cross normalize faceforward reflect refract transpose inverse determinant outerProduct
            matrixCompMult lessThan greaterThan equal notEqual any all texture texelFetch noise1 noise2 noise3
            noise4 barrier defined line file version extension pragma)");
        return std::set<std::string, std::less<>>(std::istream_iterator<std::string>(words), {});
    }();

    std::string name;
    for (const char c : file)
        if (c != '_' || !name.ends_with('_')) name += c;
    if (name.starts_with("gl_") || name.starts_with("lb_")) name.insert(0, "form_");
    const bool is_taken = glsl_words.contains(name) || reserved_names_of_glsl(shape).contains(name);
    return is_taken && !name.ends_with('_') ? name + "_" : name;
}

class ShaderCode final : public TapeCode {
public:
    ShaderCode(const Tape& tape, const Intersector& form, bool has_t)
        : TapeCode(tape, form, has_t ? std::vector{tape.outputs.hit, tape.outputs.t} : std::vector{tape.outputs.hit},
                   {"", reserved_names_of_glsl(row_of(form.shape))}) {}

private:
    [[nodiscard]] bool is_pair(NodeId i) const { return tape_.format_of(i).precision == 48; }
    [[nodiscard]] bool is_double(NodeId i) const { return tape_.format_of(i) == binary64; }
    /// Operand that has the format of the operation.
    [[nodiscard]] NodeId typed_operand(NodeId i) const {
        return tape_[i].operands[tape_[i].op == TapeOp::select ? 1 : 0];
    }

    [[nodiscard]] std::string statement(NodeId i) const override {
        const char* const type = is_decision(tape_[i].op) ? "bool"
                                 : is_pair(i)             ? "precise vec2"
                                 : is_double(i)           ? "precise double"
                                                          : "precise float";
        return fmt::format("{} {} = {};", type, name(i), expression(i));
    }
    [[nodiscard]] std::string constant(NodeId i) const override {
        const std::string number = fmt::format("{}.0", static_cast<int>(tape_[i].operands[0]));
        return is_pair(i) ? fmt::format("vec2({}, 0.0)", number) : is_double(i) ? number + "LF" : number;
    }
    [[nodiscard]] int precedence(NodeId i) const override {
        const TapeNode& n = tape_[i];
        const bool is_pair_choice = (n.op == TapeOp::min || n.op == TapeOp::max) && is_pair(i);
        if (n.op == TapeOp::select || is_pair_choice) return -1;
        return n.op == TapeOp::convert ? 4 : measure::attribution::text_of(n.op).precedence.value;
    }
    [[nodiscard]] std::string expression(NodeId i) const override {
        const TapeNode& n = tape_[i];
        if (n.op == TapeOp::any) return operand(n.operands[0], 0);
        const bool is_logic = kind_of(n.op) == OperationKind::logic;
        return measure::attribution::fill_pattern(
            is_logic ? measure::attribution::text_of(n.op).c.text : pattern(i), [&](std::size_t k, int precedence) {
                return operand(n.operands[k], is_logic || is_comparison(n.op) ? 1 : precedence);
            });
    }
    [[nodiscard]] std::string_view pattern(NodeId i) const {
        const TapeOp op = tape_[i].op;
        if (op == TapeOp::convert) return conversion(i);
        const NodeId typed_node = typed_operand(i);
        if (op == TapeOp::select) return "$1:1 ? $2 : $3";
        if (is_pair(typed_node)) return pair_pattern(op);
        switch (op) {
            case TapeOp::add: return "$1:1 + $2:2";
            case TapeOp::min: return is_double(typed_node) ? "least_of_doubles($1, $2)" : "least($1, $2)";
            case TapeOp::max: return is_double(typed_node) ? "most_of_doubles($1, $2)" : "most($1, $2)";
            case TapeOp::fma:
                return is_double(typed_node) ? fail_missing_operation("an fma of doubles") : "fused($1, $2, $3)";
            case TapeOp::copysign:
                return is_double(typed_node) ? fail_missing_operation("the sign of a double on another")
                                             : "with_sign($1, $2)";
            case TapeOp::next_up:
            case TapeOp::next_down: return fail_missing_operation("the number next to another");
            default: return measure::attribution::text_of(op).plain.text;
        }
    }
    [[nodiscard]] std::string_view conversion(NodeId i) const {
        if (is_pair(i)) return "vec2($1, 0.0)";
        if (is_double(i)) return "double($1)";
        return is_pair(tape_[i].operands[0]) ? "$1:4.x" : "float($1)";
    }
    static std::string_view pair_pattern(TapeOp op) {
        switch (op) {
            case TapeOp::add: return "plus($1, $2)";
            case TapeOp::sub: return "plus($1, -$2:3)";
            case TapeOp::mul: return "times($1, $2)";
            case TapeOp::div: return "over($1, $2)";
            case TapeOp::sqrt: return "root($1)";
            case TapeOp::fma: return "plus(times($1, $2), $3)";
            case TapeOp::neg: return "-$1:3";
            case TapeOp::abs: return "size_of($1)";
            case TapeOp::less: return "below($1, $2)";
            case TapeOp::greater: return "below($2, $1)";
            case TapeOp::less_equal: return "not_above($1, $2)";
            case TapeOp::greater_equal: return "not_above($2, $1)";
            case TapeOp::min: return "below($1, $2) ? $1 : $2";
            case TapeOp::max: return "below($2, $1) ? $1 : $2";
            default: return fail_missing_operation("this operation of two floats");
        }
    }
    [[noreturn]] static std::string_view fail_missing_operation(const char* what) {
        throw InputError(std::string("GLSL does not have ") + what +
                         ", which the repaired form needs; use --emit NAME.hpp to write it as C++");
    }
};

/// `vec3 centre, float radius`
std::string parameter_list(const ShapeRow& shape) {
    std::string text;
    for (const Key& key : shape.keys) text += fmt::format(", {} {}", key.count() == 3 ? "vec3" : "float", key.name);
    return text + (shape.takes_tmax ? ", float tmax" : "");
}

/// Properties of the function for the external intersector that reads the shader.
std::string contract_comment(const intersect::Info& info, const FormTexts& texts) {
    using namespace intersect;
    std::string text = fmt::format(
        "direction={} touching={} at_origin={} inside={}", info.direction == Direction::unit ? "unit" : "any",
        info.touching == Touching::miss ? "miss" : "hit", at_origin_names[static_cast<std::size_t>(info.at_origin)],
        inside_names[static_cast<std::size_t>(info.inside)]);
    if (info.roots != Roots::none) text += info.roots == Roots::near_only ? " roots=near" : " roots=first";
    if (info.facing != Facing::both)
        text += fmt::format(" facing={}", facing_names[static_cast<std::size_t>(info.facing)]);
    if (info.endless) text += " flags=no_end";
    std::string title = file::line_comment(texts.title);
    std::ranges::replace(title, '"', '\'');  // quotation marks delimit the value and cannot be escaped
    return fmt::format("// lostbits: {}\n// lostbits: title=\"{}\"\n", text, title);
}

/// Comment at the top. A blank breaks each `lostbits:` in it, the mark after which `--shader` reads properties.
std::string head_without_mark(const FormTexts& texts) {
    std::string head = head_comment(texts);
    const std::string mark = "lostbits:";
    for (std::size_t position = 0; (position = head.find(mark, position)) != std::string::npos; position += mark.size())
        head.insert(position + mark.size() - 1, " ");
    return head;
}

/// The helpers that the body calls, and those that these call, in the order of `helpers`.
std::string called_helpers(const std::string& body) {
    std::string functions;
    for (auto helper = helpers.rbegin(); helper != helpers.rend(); ++helper) {
        const std::string call = fmt::format("{}(", helper->name);
        const auto is_called_in = [&call](const std::string& text) {
            for (std::size_t position = text.find(call); position != std::string::npos;
                 position = text.find(call, position + 1))
                if (std::string_view(" (-!").find(text[position - 1]) != std::string_view::npos) return true;
            return false;
        };
        if (is_called_in(body) || is_called_in(functions)) functions = std::string(helper->text) + "\n" + functions;
    }
    return functions;
}

}  // namespace

std::string shader_code(const Tape& tape, const Intersector& form, const FormTexts& texts) {
    if (tape.format_of(tape.outputs.t) != binary32)
        throw InputError("a shader computes in floats; repair the form in f32, or write it as C++ (--emit NAME.hpp)");

    const bool has_t = form.info->roots != intersect::Roots::none;
    const ShaderCode code(tape, form, has_t);
    std::string body;
    for (const std::string& line : code.statements()) body += "    " + line + "\n";
    if (has_t) body += fmt::format("    first = {};\n", code.operand(tape.outputs.t, 0));
    body += fmt::format("    return {};\n", code.operand(tape.outputs.hit, 0));

    const std::string name = function_name(texts.name, row_of(form.shape));
    return fmt::format("{}{}\n{}bool {}(vec3 o, vec3 d{}{}) {{\n{}}}\n", head_without_mark(texts),
                       contract_comment(*form.info, texts), called_helpers(body), name,
                       parameter_list(row_of(form.shape)), has_t ? ", out float first" : "", body);
}

}  // namespace lostbits::output::repair
