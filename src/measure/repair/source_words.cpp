#include "measure/repair/source_words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace lostbits::measure::repair {

using intersect::function::FileLanguage;

namespace {

bool is_shader(FileLanguage language) { return language == FileLanguage::glsl || language == FileLanguage::hlsl; }

/// Pattern of a function that each language names in its own way; empty if the language has no such function.
std::string_view function_pattern_in(FileLanguage language, TapeOp op, bool is_double) {
    const bool is_rust = language == FileLanguage::rust, is_hlsl = language == FileLanguage::hlsl,
               is_any_shader = is_shader(language);
    switch (op) {
        case TapeOp::sqrt: return is_rust ? "$1:5.sqrt()" : is_any_shader || is_double ? "sqrt($1)" : "sqrtf($1)";
        case TapeOp::abs:
            return is_rust ? "$1:5.abs()" : is_any_shader ? "abs($1)" : is_double ? "fabs($1)" : "fabsf($1)";
        case TapeOp::fma:
            if (is_rust) return "$1:5.mul_add($2, $3)";
            if (is_hlsl) return is_double ? "fma($1, $2, $3)" : "mad($1, $2, $3)";
            return is_any_shader || is_double ? "fma($1, $2, $3)" : "fmaf($1, $2, $3)";
        case TapeOp::copysign:
            if (is_rust) return "$1:5.copysign($2)";
            if (is_any_shader && is_double) return "";
            if (is_hlsl) return "asfloat((asuint($1) & 0x7fffffffu) | (asuint($2) & 0x80000000u))";
            if (is_any_shader)
                return "uintBitsToFloat((floatBitsToUint($1) & 0x7fffffffu) | (floatBitsToUint($2) & 0x80000000u))";
            return is_double ? "copysign($1, $2)" : "copysignf($1, $2)";
        default: return "";
    }
}

}  // namespace

SourcePattern operation_pattern(FileLanguage language, TapeOp op, bool is_double) {
    const bool is_rust = language == FileLanguage::rust;
    switch (op) {
        case TapeOp::add: return {"$1:1 + $2:2", SourcePrecedence::sum};
        case TapeOp::sub: return {"$1:1 - $2:2", SourcePrecedence::sum};
        case TapeOp::mul: return {"$1:2 * $2:3", SourcePrecedence::product};
        case TapeOp::div: return {"$1:2 / $2:3", SourcePrecedence::product};
        case TapeOp::neg: return {"-$1:4", SourcePrecedence::sign};
        case TapeOp::less: return {"$1:1 < $2:1", SourcePrecedence::comparison};
        case TapeOp::less_equal: return {"$1:1 <= $2:1", SourcePrecedence::comparison};
        case TapeOp::greater: return {"$1:1 > $2:1", SourcePrecedence::comparison};
        case TapeOp::greater_equal: return {"$1:1 >= $2:1", SourcePrecedence::comparison};
        case TapeOp::logical_and: return {"$1:0 && $2:0", SourcePrecedence::logic};
        case TapeOp::logical_or: return {"$1:0 || $2:0", SourcePrecedence::logic};
        case TapeOp::logical_not: return {"!$1:4", SourcePrecedence::sign};
        case TapeOp::select:
            return {is_rust ? "if $1 { $2 } else { $3 }" : "$1:0 ? $2:0 : $3:0", SourcePrecedence::choice};
        case TapeOp::min:
            return {is_rust ? "if $1:1 < $2:1 { $1 } else { $2 }" : "$1:1 < $2:1 ? $1:0 : $2:0",
                    SourcePrecedence::choice};
        case TapeOp::max:
            return {is_rust ? "if $1:1 > $2:1 { $1 } else { $2 }" : "$1:1 > $2:1 ? $1:0 : $2:0",
                    SourcePrecedence::choice};
        default: return {function_pattern_in(language, op, is_double), SourcePrecedence::call};
    }
}

SourcePattern conversion_in(FileLanguage language, bool to_double) {
    switch (language) {
        case FileLanguage::rust: return {to_double ? "($1:4 as f64)" : "($1:4 as f32)", SourcePrecedence::call};
        case FileLanguage::glsl: return {to_double ? "double($1)" : "float($1)", SourcePrecedence::call};
        default: return {to_double ? "(double)$1:4" : "(float)$1:4", SourcePrecedence::sign};
    }
}

std::string literal_in(FileLanguage language, double x, bool is_double) {
    if (!std::isfinite(x)) return "";
    std::string digits = is_double ? fmt::format("{}", x) : fmt::format("{}", static_cast<float>(x));
    if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
    if (language == FileLanguage::c || language == FileLanguage::cpp) return is_double ? digits : digits + "f";
    if (language == FileLanguage::glsl && is_double) return digits + "lf";
    return language == FileLanguage::hlsl && is_double ? digits + "L" : digits;
}

std::string declaration_in(FileLanguage language, const std::string& name, bool is_double, bool is_boolean) {
    if (language == FileLanguage::rust) return "let " + name + " = ";
    const char* const type = is_boolean  ? (language == FileLanguage::c ? "int" : "bool")
                             : is_double ? "double"
                                         : "float";
    return std::string(type) + " " + name + " = ";
}

}  // namespace lostbits::measure::repair
