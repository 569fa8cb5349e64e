// Arithmetic instructions of SPIR-V, and those of GLSL.std.450 by the formulas of their specification.
#include <limits>
#include <map>

#include "intersect/spirv/translator.hpp"

namespace lostbits::intersect::spirv {
namespace {

/// Instructions of SPIR-V, and the instructions of LLVM IR that do the same.
using Counterparts = std::map<std::string_view, std::string_view>;

const Counterparts binaries{{"OpFAdd", "fadd"},
                            {"OpFSub", "fsub"},
                            {"OpFMul", "fmul"},
                            {"OpFDiv", "fdiv"},
                            {"OpIAdd", "add"},
                            {"OpISub", "sub"},
                            {"OpIMul", "mul"},
                            {"OpSDiv", "sdiv"},
                            {"OpUDiv", "udiv"},
                            {"OpSRem", "srem"},
                            {"OpUMod", "urem"},
                            {"OpShiftLeftLogical", "shl"},
                            {"OpShiftRightLogical", "lshr"},
                            {"OpShiftRightArithmetic", "ashr"},
                            {"OpBitwiseAnd", "and"},
                            {"OpBitwiseOr", "or"},
                            {"OpBitwiseXor", "xor"},
                            {"OpLogicalAnd", "and"},
                            {"OpLogicalOr", "or"}};

const Counterparts comparisons{{"OpFOrdEqual", "fcmp oeq"},
                               {"OpFUnordEqual", "fcmp ueq"},
                               {"OpFOrdNotEqual", "fcmp one"},
                               {"OpFUnordNotEqual", "fcmp une"},
                               {"OpFOrdLessThan", "fcmp olt"},
                               {"OpFUnordLessThan", "fcmp ult"},
                               {"OpFOrdGreaterThan", "fcmp ogt"},
                               {"OpFUnordGreaterThan", "fcmp ugt"},
                               {"OpFOrdLessThanEqual", "fcmp ole"},
                               {"OpFUnordLessThanEqual", "fcmp ule"},
                               {"OpFOrdGreaterThanEqual", "fcmp oge"},
                               {"OpFUnordGreaterThanEqual", "fcmp uge"},
                               {"OpIEqual", "icmp eq"},
                               {"OpINotEqual", "icmp ne"},
                               {"OpLogicalEqual", "icmp eq"},
                               {"OpLogicalNotEqual", "icmp ne"},
                               {"OpSLessThan", "icmp slt"},
                               {"OpULessThan", "icmp ult"},
                               {"OpSGreaterThan", "icmp sgt"},
                               {"OpUGreaterThan", "icmp ugt"},
                               {"OpSLessThanEqual", "icmp sle"},
                               {"OpULessThanEqual", "icmp ule"},
                               {"OpSGreaterThanEqual", "icmp sge"},
                               {"OpUGreaterThanEqual", "icmp uge"}};

const Counterparts conversions{{"OpConvertFToS", "fptosi"},
                               {"OpConvertFToU", "fptoui"},
                               {"OpConvertSToF", "sitofp"},
                               {"OpConvertUToF", "uitofp"},
                               {"OpBitcast", "bitcast"}};

std::string counterpart(const Counterparts& counterparts, std::string_view op) {
    const auto entry = counterparts.find(op);
    return entry == counterparts.end() ? "" : std::string(entry->second);
}

}  // namespace

TypedText Translator::emit_binary(const std::string& op, const TypedText& a, const TypedText& b) {
    return emit(*a.type, op + " " + a.typed() + ", " + b.text);
}

TypedText Translator::compare(const std::string& op, const TypedText& a, const TypedText& b) {
    const SpirvType& boolean = integer_type(Kind::boolean, 1);
    return emit(a.type->kind == Kind::vector ? vector_of(boolean, a.type->count) : boolean,
                op + " " + a.typed() + ", " + b.text);
}

TypedText Translator::select(const TypedText& when, const TypedText& a, const TypedText& b) {
    return emit(*a.type, "select " + when.typed() + ", " + a.typed() + ", " + b.typed());
}

/// Calls `llvm.NAME` with values of one type.
TypedText Translator::emit_intrinsic(const std::string& name, const Values& x) {
    const SpirvType& type = *x[0].type;
    std::string arguments, parameter_types;
    for (const TypedText& v : x) {
        arguments += (arguments.empty() ? "" : ", ") + v.typed();
        parameter_types += (parameter_types.empty() ? "" : ", ") + type.text;
    }
    const std::string lanes = type.kind == Kind::vector ? "v" + std::to_string(type.count) : "";
    const std::string function_name = "@llvm." + name + "." + lanes + "f" + std::to_string(x[0].lane().bits);
    declarations_.insert("declare " + type.text + " " + function_name + "(" + parameter_types + ")");
    return emit(type, "call " + type.text + " " + function_name + "(" + arguments + ")");
}

TypedText Translator::splat(double x, const SpirvType& type) {
    const TypedText lane{type.kind == Kind::vector ? type.parts[0] : &type, {}, {}};
    const std::string lane_text = literal(x, *lane.type);
    if (type.kind != Kind::vector) return {&type, lane_text, {}};
    std::string lanes;
    for (std::size_t k = 0; k < type.count; ++k) lanes += (k == 0 ? "" : ", ") + lane.type->text + " " + lane_text;
    return {&type, "<" + lanes + ">", {}};
}

TypedText Translator::scale(const TypedText& vector, const TypedText& scalar) {
    return emit_binary("fmul", vector, construct(*vector.type, Values(vector.type->count, scalar)));
}

/// x₁y₁ + x₂y₂ + ..., added from the left.
TypedText Translator::dot(const TypedText& a, const TypedText& b) {
    const TypedText products = emit_binary("fmul", a, b);
    if (a.type->kind != Kind::vector) return products;
    TypedText sum = extract_part(products, 0);
    for (std::size_t k = 1; k < a.type->count; ++k) sum = emit_binary("fadd", sum, extract_part(products, k));
    return sum;
}

TypedText Translator::length(const TypedText& a) {
    return a.type->kind == Kind::vector ? emit_intrinsic("sqrt", {dot(a, a)}) : emit_intrinsic("fabs", {a});
}

/// The sum of the columns times the lanes of the vector, added from the left.
TypedText Translator::matrix_times_vector(const TypedText& matrix, const TypedText& vector) {
    TypedText sum = scale(extract_part(matrix, 0), extract_part(vector, 0));
    for (std::size_t k = 1; k < matrix.type->count; ++k)
        sum = emit_binary("fadd", sum, scale(extract_part(matrix, k), extract_part(vector, k)));
    return sum;
}

bool Translator::translate_matrix(const SpirvInstruction& instruction) {
    if (instruction.op.find("Times") == std::string::npos && instruction.op != "OpTranspose") return false;
    const auto require_few = [&instruction](const SpirvType& type) -> const SpirvType& {
        if (type.count > 16) instruction.fail("neither a vector nor a matrix");
        return type;
    };
    const auto operand = [&](std::size_t k) {
        const TypedText x = value(instruction.at(k), instruction);
        require_few(*x.type);
        return x;
    };
    const SpirvType& type = require_few(type_of(instruction.at(0), instruction));
    const TypedText a = operand(1);
    const auto b = [&] { return operand(2); };

    // Products that are vectors.
    if (instruction.op == "OpVectorTimesScalar") {
        values_[instruction.result] = scale(a, b());
        return true;
    }
    if (instruction.op == "OpMatrixTimesVector") {
        values_[instruction.result] = matrix_times_vector(a, b());
        return true;
    }

    // Results that are made column by column, or lane by lane.
    Values columns;
    if (instruction.op == "OpMatrixTimesScalar")
        for (std::size_t k = 0; k < type.count; ++k) columns.push_back(scale(extract_part(a, k), b()));
    else if (instruction.op == "OpVectorTimesMatrix")
        for (std::size_t k = 0; k < type.count; ++k) columns.push_back(dot(a, extract_part(b(), k)));
    else if (instruction.op == "OpMatrixTimesMatrix")
        for (std::size_t k = 0; k < type.count; ++k) columns.push_back(matrix_times_vector(a, extract_part(b(), k)));
    else if (instruction.op == "OpTranspose" && type.part(0) != nullptr) {
        for (std::size_t k = 0; k < type.count; ++k) {
            Values lanes;
            for (std::size_t row_index = 0; row_index < a.type->count; ++row_index)
                lanes.push_back(extract_part(extract_part(a, row_index), k));
            columns.push_back(construct(*type.parts[0], lanes));
        }
    } else return false;
    values_[instruction.result] = construct(type, columns);
    return true;
}

bool Translator::translate_arithmetic(const SpirvInstruction& instruction) {
    if (instruction.result.empty()) return false;
    const SpirvType& type = type_of(instruction.at(0), instruction);
    const auto x = [&](std::size_t k) { return value(instruction.at(k), instruction); };
    TypedText& result = values_[instruction.result];

    // Instructions with a counterpart in LLVM IR.
    if (const std::string op = counterpart(binaries, instruction.op); !op.empty()) {
        result = emit_binary(op, x(1), x(2));
        return true;
    }
    if (const std::string comparison = counterpart(comparisons, instruction.op); !comparison.empty()) {
        result = compare(comparison, x(1), x(2));
        return true;
    }
    if (const std::string conversion = counterpart(conversions, instruction.op); !conversion.empty()) {
        result = emit(type, conversion + " " + x(1).typed() + " to " + type.text);
        return true;
    }

    // Other instructions, by their meanings.
    if (instruction.op == "OpFConvert" || instruction.op == "OpSConvert" || instruction.op == "OpUConvert") {
        const TypedText operand = x(1);
        const bool widens = TypedText{&type}.lane().bits > operand.lane().bits;
        const std::string instruction_name = instruction.op == "OpFConvert"   ? (widens ? "fpext" : "fptrunc")
                                             : !widens                        ? "trunc"
                                             : instruction.op == "OpSConvert" ? "sext"
                                                                              : "zext";
        result = emit(type, instruction_name + " " + operand.typed() + " to " + type.text);
    } else if (instruction.op == "OpFNegate") result = emit(type, "fneg " + x(1).typed());
    else if (instruction.op == "OpFMod" || instruction.op == "OpFRem") {  // x - y floor(x/y), x - y trunc(x/y)
        const TypedText rounded_quotient =
            emit_intrinsic(instruction.op == "OpFMod" ? "floor" : "trunc", {emit_binary("fdiv", x(1), x(2))});
        result = emit_binary("fsub", x(1), emit_binary("fmul", x(2), rounded_quotient));
    } else if (instruction.op == "OpSNegate") result = emit_binary("sub", {&type, "zeroinitializer", {}}, x(1));
    else if (instruction.op == "OpLogicalNot") result = compare("icmp eq", x(1), {&type, "zeroinitializer", {}});
    else if (instruction.op == "OpSelect") result = select(x(1), x(2), x(3));
    else if (instruction.op == "OpDot") result = dot(x(1), x(2));
    else if (instruction.op == "OpIsNan") result = compare("fcmp uno", x(1), x(1));
    else if (instruction.op == "OpIsInf")
        result = compare("fcmp oeq", emit_intrinsic("fabs", {x(1)}),
                         splat(std::numeric_limits<double>::infinity(), *x(1).type));
    else if (instruction.op == "OpAny" || instruction.op == "OpAll") {
        const TypedText vector = x(1);
        if (vector.type->kind != Kind::vector) instruction.fail("a vector is missing");
        result = extract_part(vector, 0);
        for (std::size_t k = 1; k < vector.type->count; ++k)
            result = emit_binary(instruction.op == "OpAny" ? "or" : "and", result, extract_part(vector, k));
    } else if (instruction.op == "OpExtInst" && strings_[instruction.at(1)] == "GLSL.std.450") {
        Values arguments;
        for (std::size_t k = 3; k < instruction.operands.size(); ++k) arguments.push_back(x(k));
        result = translate_extended_instruction(instruction, instruction.at(2), type, arguments);
    } else {
        values_.erase(instruction.result);
        return false;
    }
    return true;
}

/// Translates an instruction of GLSL.std.450 to the operations of its formula in the specification, from the left to
/// the right.
TypedText Translator::translate_extended_instruction(const SpirvInstruction& instruction, const std::string& name,
                                                     const SpirvType& type, const Values& x) {
    // The names with the number of their operands.
    static const std::map<std::string_view, std::size_t> formulas{
        {"InverseSqrt", 1}, {"FMin", 2},      {"FMax", 2},        {"FClamp", 3},  {"NClamp", 3}, {"FSign", 1},
        {"FMix", 3},        {"Step", 2},      {"SmoothStep", 3},  {"SAbs", 1},    {"SMin", 2},   {"SMax", 2},
        {"UMin", 2},        {"UMax", 2},      {"SClamp", 3},      {"UClamp", 3},  {"Length", 1}, {"Distance", 2},
        {"Cross", 2},       {"Normalize", 1}, {"FaceForward", 3}, {"Reflect", 2}, {"Fract", 1}};
    static const Counterparts intrinsics{{"Sqrt", "sqrt"},       {"FAbs", "fabs"},          {"Fma", "fma"},
                                         {"NMin", "minnum"},     {"NMax", "maxnum"},        {"Pow", "pow"},
                                         {"Floor", "floor"},     {"Ceil", "ceil"},          {"Trunc", "trunc"},
                                         {"Round", "roundeven"}, {"RoundEven", "roundeven"}};

    if (const std::string intrinsic_name = counterpart(intrinsics, name); !intrinsic_name.empty() && !x.empty())
        return emit_intrinsic(intrinsic_name, x);

    // The message names the function as GLSL does: `sin` for Sin, `abs` for FAbs.
    const auto formula = formulas.find(name);
    if (formula == formulas.end()) {
        const bool has_type_letter =
            name.size() > 1 && (name[0] == 'F' || name[0] == 'S') && name[1] >= 'A' && name[1] <= 'Z';
        std::string function_name = has_type_letter ? name.substr(1) : name;
        if (!function_name.empty()) function_name[0] = static_cast<char>(function_name[0] | 0x20);
        return refuse(type, "it calls " + function_name + ", which is not followed");
    }
    if (x.size() < formula->second) instruction.fail("an operand is missing");

    // The parts of which formulas consist.
    const auto choose = [&](const std::string& op, const TypedText& a, const TypedText& b) {
        return select(compare(op, a, b), a, b);
    };
    const auto smaller = [&](const TypedText& a, const TypedText& b) { return choose("fcmp olt", b, a); };
    const auto larger = [&](const TypedText& a, const TypedText& b) { return select(compare("fcmp olt", a, b), b, a); };
    const auto constant = [&](double c) { return splat(c, type); };
    const auto clamp = [&](const TypedText& a, const TypedText& lo, const TypedText& hi) {
        return smaller(larger(a, lo), hi);
    };

    // Floating-point numbers
    if (name == "InverseSqrt") return emit_binary("fdiv", constant(1), emit_intrinsic("sqrt", x));
    if (name == "Fract") return emit_binary("fsub", x[0], emit_intrinsic("floor", x));
    if (name == "FMin") return smaller(x[0], x[1]);
    if (name == "FMax") return larger(x[0], x[1]);
    if (name == "FClamp") return clamp(x[0], x[1], x[2]);
    if (name == "NClamp") return emit_intrinsic("minnum", {emit_intrinsic("maxnum", {x[0], x[1]}), x[2]});
    if (name == "FSign") {
        const TypedText zero_or_negative_sign =
            select(compare("fcmp olt", x[0], constant(0)), constant(-1), constant(0));
        return select(compare("fcmp ogt", x[0], constant(0)), constant(1), zero_or_negative_sign);
    }
    if (name == "FMix")
        return emit_binary("fadd", emit_binary("fmul", x[0], emit_binary("fsub", constant(1), x[2])),
                           emit_binary("fmul", x[1], x[2]));
    if (name == "Step") return select(compare("fcmp olt", x[1], x[0]), constant(0), constant(1));
    if (name == "SmoothStep") {
        const TypedText t = clamp(emit_binary("fdiv", emit_binary("fsub", x[2], x[0]), emit_binary("fsub", x[1], x[0])),
                                  constant(0), constant(1));
        return emit_binary("fmul", emit_binary("fmul", t, t),
                           emit_binary("fsub", constant(3), emit_binary("fmul", constant(2), t)));
    }

    // Integers
    const std::string type_letter(1, static_cast<char>(name[0] | 0x20));  // s or u
    if (name == "SAbs") {
        const TypedText zero{&type, "zeroinitializer", {}};
        return choose("icmp sgt", x[0], emit_binary("sub", zero, x[0]));
    }
    if (name.ends_with("Min")) return choose("icmp " + type_letter + "lt", x[0], x[1]);
    if (name.ends_with("Max")) return choose("icmp " + type_letter + "gt", x[0], x[1]);
    if (name.ends_with("Clamp"))
        return choose("icmp " + type_letter + "lt", choose("icmp " + type_letter + "gt", x[0], x[1]), x[2]);
    return translate_geometric(name, x);
}

TypedText Translator::translate_geometric(const std::string& name, const Values& x) {
    if (name == "Length") return length(x[0]);
    if (name == "Distance") return length(emit_binary("fsub", x[0], x[1]));
    if (name == "Normalize") {
        const TypedText x_length = length(x[0]);
        const bool is_vector = x[0].type->kind == Kind::vector;
        return emit_binary("fdiv", x[0],
                           is_vector ? construct(*x[0].type, Values(x[0].type->count, x_length)) : x_length);
    }

    // N, I and Nref, or I and N, in the words of GLSL
    if (name == "FaceForward")
        return select(compare("fcmp olt", dot(x[2], x[1]), splat(0, x[0].lane())), x[0],
                      emit(*x[0].type, "fneg " + x[0].typed()));
    if (name == "Reflect") {
        const TypedText twice_dot = emit_binary("fmul", splat(2, x[0].lane()), dot(x[1], x[0]));
        return emit_binary(
            "fsub", x[0],
            x[0].type->kind == Kind::vector ? scale(x[1], twice_dot) : emit_binary("fmul", x[1], twice_dot));
    }

    // Cross: x₁y₂ − y₁x₂, x₂y₀ − y₂x₀, x₀y₁ − y₀x₁
    Values lanes;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        lanes.push_back(emit_binary("fsub", emit_binary("fmul", extract_part(x[0], a), extract_part(x[1], b)),
                                    emit_binary("fmul", extract_part(x[1], a), extract_part(x[0], b))));
    }
    return construct(*x[0].type, lanes);
}

}  // namespace lostbits::intersect::spirv
