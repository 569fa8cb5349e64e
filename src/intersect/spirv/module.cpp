// Translates types, constants and variables of a module, and writes its debug information.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "intersect/spirv/llvm_text.hpp"
#include "intersect/spirv/translator.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::spirv {
namespace {

constexpr std::size_t max_bytes = 1 << 20;  // limit of a type or of a constant's text

std::size_t number_operand(const SpirvInstruction& instruction, std::size_t k) {
    const std::string& digits = instruction.at(k);
    std::size_t n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc() || end != digits.data() + digits.size()) instruction.fail("a number is missing");
    return n;
}

/// Reads "0.5", "-0x1p-130" and, for infinity and NaN, "0x1p+128" and "0x1.8p+128".
double number_of(std::string_view text, int bits) {
    const bool is_negative = text.starts_with('-');
    if (is_negative) text.remove_prefix(1);
    const bool is_hex = text.starts_with("0x");
    if (is_hex) text.remove_prefix(2);
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x,
                                              is_hex ? std::chars_format::hex : std::chars_format::general);
    const bool is_infinite_or_nan = bits == 32 ? x >= 0x1p128 : text.ends_with("p+1024");
    if (is_infinite_or_nan && text.starts_with("1p")) x = std::numeric_limits<double>::infinity();
    else if (is_infinite_or_nan) x = std::numeric_limits<double>::quiet_NaN();
    static_cast<void>(end);
    static_cast<void>(error);
    return is_negative ? -x : x;
}

}  // namespace

const SpirvType* SpirvType::part(std::size_t k) const {
    if (kind == Kind::structure) return k < parts.size() ? parts[k] : nullptr;
    const bool has_items = kind == Kind::vector || kind == Kind::matrix || kind == Kind::array;
    return has_items && k < count ? parts[0] : nullptr;
}

Translator::Translator(const std::vector<SpirvInstruction>& instructions, std::string path, const ShaderLines& lines,
                       bool has_opaque_pointers)
    : instructions_(instructions),
      path_(std::move(path)),
      lines_(lines),
      places_(lines),
      has_opaque_pointers_(has_opaque_pointers) {}

std::string Translator::name_of(const std::string& id) const {
    const auto entry = names_.find(id);
    if (entry == names_.end()) return "";
    std::string name = entry->second.substr(0, entry->second.find('('));
    return name.starts_with('@') ? name.substr(1) : name;  // glslang writes "@f(vf3;" in HLSL
}

/// Collects names, functions, and the values that are written to each variable.
void Translator::collect_names() {
    std::map<std::string, std::string> variable_of_part;  // by the address of a part
    std::string entry;
    bool in_entry = false;
    const auto variable_of = [&](const std::string& id) {
        return variable_of_part.contains(id) ? variable_of_part[id] : id;
    };
    const auto count_write = [&](const std::string& id, const std::string& value) {
        VariableWrites& writes = variable_writes_[variable_of(id)];
        ++writes.count;
        writes.value = value;
    };
    for (const SpirvInstruction& instruction : instructions_) {
        // Names
        if (instruction.op == "OpName") names_[instruction.at(0)] = instruction.at(1);
        if (instruction.op == "OpMemberName")
            member_names_[{instruction.at(0), number_operand(instruction, 1)}] = instruction.at(2);
        if (instruction.op == "OpExtInstImport" || instruction.op == "OpString")
            strings_[instruction.result] = instruction.at(0);
        if (instruction.op == "OpFunction") functions_[instruction.result] = &instruction;
        if (instruction.op == "OpEntryPoint") {
            names_.try_emplace(instruction.at(1), instruction.at(2));
            entry = instruction.at(1);
        }

        // Writes. Only a value that the main function writes to a whole variable may be the value of the variable.
        if (instruction.op == "OpFunction") in_entry = instruction.result == entry;
        if (instruction.op == "OpAccessChain" || instruction.op == "OpInBoundsAccessChain")
            variable_of_part[instruction.result] = variable_of(instruction.at(1));
        if (instruction.op == "OpStore")
            count_write(instruction.at(0),
                        in_entry && !variable_of_part.contains(instruction.at(0)) ? instruction.at(1) : "");
        for (std::size_t k = 2; instruction.op == "OpFunctionCall" && k < instruction.operands.size(); ++k)
            count_write(instruction.at(k), "");
    }
}

const SpirvType& Translator::type_of(const std::string& id, const SpirvInstruction& instruction) const {
    const auto entry = types_.find(id);
    if (entry == types_.end()) instruction.fail("the type %" + id + " is unknown");
    return entry->second;
}

const SpirvType& Translator::integer_type(Kind kind, int bits) {
    const std::string text = "i" + std::to_string(bits), id = "." + text;
    const auto bytes = static_cast<std::size_t>(std::max(bits / 8, 1));
    return types_.try_emplace(id, SpirvType{kind, id, text, bytes, bytes, bits}).first->second;
}

const SpirvType& Translator::vector_of(const SpirvType& lane, std::size_t count) {
    const std::string id = lane.id + "." + std::to_string(count);
    std::size_t size = 1;
    while (size < lane.size * count) size *= 2;
    const std::string text = "<" + std::to_string(count) + " x " + lane.text + ">";
    return types_.try_emplace(id, SpirvType{Kind::vector, id, text, size, size, 0, false, {&lane}, count})
        .first->second;
}

const SpirvType& Translator::pointer_to(const SpirvType& target) {
    const std::string id = target.id + ".p";
    return types_.try_emplace(id, SpirvType{Kind::pointer, id, pointer(target), 8, 8, 0, false, {&target}, 1})
        .first->second;
}

void Translator::add_type(const SpirvInstruction& instruction, SpirvType type) {
    if (type.size > max_bytes || type.count > max_bytes) instruction.fail("a type is too large");
    if (types_.contains(instruction.result)) instruction.fail("a type is defined twice");
    type.id = instruction.result;
    types_[instruction.result] = std::move(type);
}

void Translator::declare_type(const SpirvInstruction& instruction) {
    const auto part = [&](std::size_t k) { return &type_of(instruction.at(k), instruction); };
    const auto bits = [&] { return static_cast<int>(std::min<std::size_t>(number_operand(instruction, 0), 64)); };

    // Scalars
    if (instruction.op == "OpTypeVoid")
        return add_type(instruction, {.kind = Kind::void_type, .id = {}, .text = "void"});
    if (instruction.op == "OpTypeBool")
        return add_type(instruction, {.kind = Kind::boolean, .id = {}, .text = "i1", .size = 1, .align = 1, .bits = 1});
    if (instruction.op == "OpTypeInt" || instruction.op == "OpTypeFloat") {
        const bool is_integer = instruction.op == "OpTypeInt";
        const int n = bits();
        const std::string text = is_integer ? "i" + std::to_string(n) : n == 32 ? "float" : n == 64 ? "double" : "half";
        const auto bytes = static_cast<std::size_t>(std::max(n / 8, 1));
        return add_type(instruction, {is_integer ? Kind::integer : Kind::floating,
                                      {},
                                      text,
                                      bytes,
                                      bytes,
                                      n,
                                      is_integer && instruction.at(1) == "1"});
    }

    // Vectors, matrices and arrays
    if (instruction.op == "OpTypeVector") {
        const std::size_t count = number_operand(instruction, 1);
        if (count < 2 || count > 16)
            instruction.fail("a vector has fewer than 2 or more than 16 components, which is not supported");
        return add_type(instruction, vector_of(*part(0), count));
    }
    // The number of items of an array is a constant, of a matrix a literal.
    if (instruction.op == "OpTypeMatrix" || instruction.op == "OpTypeArray") {
        const bool is_matrix = instruction.op == "OpTypeMatrix";
        const SpirvType& item = *part(0);
        const double item_count =
            is_matrix ? static_cast<double>(number_operand(instruction, 1)) : integer_constants_[instruction.at(1)];
        if (!(item_count >= 1 && item_count * static_cast<double>(item.size) <= max_bytes))
            instruction.fail("a type is too large");
        if (is_matrix && (item_count > 4 || item.kind != Kind::vector))
            instruction.fail(
                "a matrix has more than 4 columns, or columns that are not vectors, which is not supported");
        const auto count = static_cast<std::size_t>(item_count);
        return add_type(instruction, {is_matrix ? Kind::matrix : Kind::array,
                                      {},
                                      "[" + std::to_string(count) + " x " + item.text + "]",
                                      item.size * count,
                                      item.align,
                                      0,
                                      false,
                                      {&item},
                                      count});
    }

    // Types that refer to other types
    if (instruction.op == "OpTypeStruct") return declare_structure(instruction);
    if (instruction.op == "OpTypePointer" && types_.contains(instruction.at(1)))
        return add_type(instruction, pointer_to(*part(1)));
    if (instruction.op == "OpTypeFunction") {
        SpirvType function_type{.kind = Kind::function, .id = {}, .text = {}};
        for (std::size_t k = 0; k < instruction.operands.size(); ++k) function_type.parts.push_back(part(k));
        return add_type(instruction, std::move(function_type));
    }
    add_type(instruction, {.kind = Kind::other, .id = {}, .text = "i8", .size = 1, .align = 1});  // an image, a sampler
}

/// Declares a structure, whose members LLVM lays out by their alignments.
void Translator::declare_structure(const SpirvInstruction& instruction) {
    SpirvType structure{.kind = Kind::structure, .id = {}, .text = "%T." + instruction.result};
    std::string parts;
    for (std::size_t k = 0; k < instruction.operands.size(); ++k) {
        const SpirvType& part = type_of(instruction.at(k), instruction);
        structure.parts.push_back(&part);
        parts += (k == 0 ? "" : ", ") + part.text;
        structure.size = (structure.size + part.align - 1) / part.align * part.align + part.size;
        structure.align = std::max(structure.align, part.align);
        if (structure.size > max_bytes) instruction.fail("a type is too large");
    }
    structure.size = (structure.size + structure.align - 1) / structure.align * structure.align;
    definitions_.push_back(structure.text + " = type { " + parts + " }");
    add_type(instruction, std::move(structure));
}

std::string Translator::literal(double x, const SpirvType& type) const {
    if (type.bits == 32) x = static_cast<double>(static_cast<float>(x));
    std::array<char, 20> digits{};
    const auto bits = std::isnan(x) ? 0x7ff8000000000000U : std::bit_cast<std::uint64_t>(x);
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), bits, 16).ptr;
    const std::string hex(digits.data(), end);
    return "0x" + std::string(16 - std::min<std::size_t>(hex.size(), 16), '0') + hex;
}

void Translator::declare_constant(const SpirvInstruction& instruction) {
    const SpirvType& type = type_of(instruction.at(0), instruction);
    TypedText& constant = values_[instruction.result] = {&type};
    if (instruction.op.ends_with("ConstantTrue")) constant.text = "true";
    else if (instruction.op.ends_with("ConstantFalse")) constant.text = "false";
    else if (instruction.op == "OpUndef") constant.text = "undef";
    else if (instruction.op == "OpConstantNull") constant.text = zero_text(type);
    else if (instruction.op.ends_with("ConstantComposite")) constant.text = composite_text(instruction, type);
    else if (type.kind == Kind::floating) constant.text = literal(number_of(instruction.at(1), type.bits), type);
    else if (type.kind == Kind::integer && instruction.op != "OpSpecConstantOp") {
        const std::string& digits = instruction.at(1);
        std::int64_t x = 0;
        if (std::from_chars(digits.data(), digits.data() + digits.size(), x).ptr != digits.data() + digits.size())
            instruction.fail("a number is missing");
        integer_constants_[instruction.result] = static_cast<double>(x);
        constant.text = std::to_string(x);
    } else {
        constant.text = "undef";
        constant.refusal_reason =
            "it uses a constant that is computed when the shader is loaded, which is not supported";
    }
}

/// The constant of a type whose bits are all 0.
std::string Translator::zero_text(const SpirvType& type) const {
    if (type.kind == Kind::pointer) return "null";
    if (type.kind == Kind::floating) return literal(0, type);
    return type.kind == Kind::integer || type.kind == Kind::boolean ? "0" : "zeroinitializer";
}

/// A constant vector `<...>`, structure `{...}` or array `[...]`.
std::string Translator::composite_text(const SpirvInstruction& instruction, const SpirvType& type) const {
    std::string parts;
    for (std::size_t k = 1; k < instruction.operands.size(); ++k)
        parts += (k == 1 ? "" : ", ") + value(instruction.at(k), instruction).typed();
    const bool is_vector = type.kind == Kind::vector;
    const char open = is_vector ? '<' : type.kind == Kind::structure ? '{' : '[';
    const char close = is_vector ? '>' : type.kind == Kind::structure ? '}' : ']';
    std::string text = open + parts + close;
    if (text.size() > max_bytes) instruction.fail("a constant is too large");
    return text;
}

/// Declares a variable outside of functions. Its value is known if only one constant is ever written to it: at its
/// declaration, or by the main function, where glslang initialises variables.
void Translator::declare_variable(const SpirvInstruction& instruction) {
    const SpirvType& type = type_of(instruction.at(0), instruction);
    if (type.kind != Kind::pointer) instruction.fail("a variable has no address");
    const VariableWrites& writes = variable_writes_[instruction.result];
    const std::string initial = instruction.operands.size() > 2 ? instruction.at(2) : writes.value;
    const auto constant = values_.find(initial);
    const bool is_known = instruction.at(1) == "Private" && writes.count == (instruction.operands.size() > 2 ? 0 : 1) &&
                          constant != values_.end() && constant->second.type->text == type.parts[0]->text;
    const std::string global_name = "@" + quote_name("v." + instruction.result), name = name_of(instruction.result);
    values_[instruction.result] = {&type, global_name, {}};
    if (is_known) definitions_.push_back(global_name + " = internal constant " + constant->second.typed());
    else
        values_[instruction.result].refusal_reason = "it reads " +
                                                     (name.empty() ? "a variable outside of functions" : name) +
                                                     ", which nothing in the file sets to one value";
}

void Translator::declare(const SpirvInstruction& instruction) {
    const auto number = [&](std::size_t k) {
        return static_cast<int>(std::min<std::size_t>(number_operand(instruction, k), 1 << 30));
    };
    if (instruction.op == "OpLine") places_.visit(number(1), number(2));
    if (instruction.op.starts_with("OpType") && instruction.op != "OpTypeForwardPointer") declare_type(instruction);
    else if (instruction.op.starts_with("OpConstant") || instruction.op.starts_with("OpSpecConstant") ||
             instruction.op == "OpUndef")
        declare_constant(instruction);
}

// Debug information

std::string Translator::add_metadata(const std::string& text) {
    metadata_.push_back(text);
    return "!" + std::to_string(metadata_.size() - 1);
}

std::string Translator::add_vector_metadata(const SpirvType& type) {
    std::string members;
    const SpirvType& lane = *type.parts[0];
    for (std::size_t k = 0; k < type.count; ++k) {
        const std::string name = k < 4 ? std::string(1, "xyzw"[k]) : "s" + std::to_string(k);
        members += (k == 0 ? "" : ", ") +
                   add_metadata("!DIDerivedType(tag: DW_TAG_member, name: \"" + name +
                                "\", baseType: " + metadata_of(lane) + ", size: " + std::to_string(8 * lane.size) +
                                ", offset: " + std::to_string(8 * lane.size * k) + ")");
    }
    const std::string prefix = lane.kind == Kind::boolean   ? "b"
                               : lane.kind == Kind::integer ? "i"
                               : lane.bits == 64            ? "d"
                                                            : "";
    return add_metadata("!DICompositeType(tag: DW_TAG_structure_type, name: \"" + prefix + "vec" +
                        std::to_string(type.count) + "\", size: " + std::to_string(8 * type.size) +
                        ", elements: " + add_metadata("!{" + members + "}") + ")");
}

std::string Translator::add_structure_metadata(const SpirvType& type) {
    std::string members;
    std::size_t offset = 0;
    for (std::size_t k = 0; k < type.parts.size(); ++k) {
        const SpirvType& p = *type.parts[k];
        offset = (offset + p.align - 1) / p.align * p.align;
        members += (k == 0 ? "" : ", ") +
                   add_metadata("!DIDerivedType(tag: DW_TAG_member, name: " + quote_name(member_names_[{type.id, k}]) +
                                ", baseType: " + metadata_of(p) + ", size: " + std::to_string(8 * p.size) +
                                ", offset: " + std::to_string(8 * offset) + ")");
        offset += p.size;
    }
    return add_metadata("!DICompositeType(tag: DW_TAG_structure_type, name: " + quote_name(name_of(type.id)) +
                        ", size: " + std::to_string(8 * type.size) +
                        ", elements: " + add_metadata("!{" + members + "}") + ")");
}

std::string Translator::metadata_of(const SpirvType& type) {
    if (type.kind == Kind::void_type) return "null";
    std::string& known_metadata = metadata_of_types_[type.id];
    if (!known_metadata.empty()) return known_metadata;
    const std::string size = ", size: " + std::to_string(8 * type.size);
    std::string new_metadata;
    if (type.kind == Kind::vector) new_metadata = add_vector_metadata(type);
    else if (type.kind == Kind::structure) new_metadata = add_structure_metadata(type);
    else if (type.kind == Kind::matrix || type.kind == Kind::array)
        new_metadata = add_metadata(
            "!DICompositeType(tag: DW_TAG_array_type, baseType: " + metadata_of(*type.parts[0]) + size +
            ", elements: " +
            add_metadata("!{" + add_metadata("!DISubrange(count: " + std::to_string(type.count) + ")") + "}") + ")");
    else if (type.kind == Kind::pointer)
        new_metadata = add_metadata(
            "!DIDerivedType(tag: DW_TAG_reference_type, baseType: " + metadata_of(*type.parts[0]) + ", size: 64)");
    else
        new_metadata = add_metadata("!DIBasicType(name: \"" + (type.kind == Kind::boolean ? "bool" : type.text) + "\"" +
                                    size + ", encoding: " +
                                    (type.kind == Kind::floating  ? "DW_ATE_float"
                                     : type.kind == Kind::boolean ? "DW_ATE_boolean"
                                     : type.is_signed             ? "DW_ATE_signed"
                                                                  : "DW_ATE_unsigned") +
                                    ")");
    return metadata_of_types_[type.id] = new_metadata;
}

/// Returns `, !dbg !12`, the reference to the place of an instruction.
std::string Translator::debug_suffix(const SpirvInstruction& instruction) {
    std::string name;
    if (instruction.op == "OpExtInst") name = instruction.at(2);
    TokenPlace p = places_.place_of(instruction.op, name);
    if (lines_.file.empty()) {
        p.line = instruction.line;
        p.column = instruction.column;
    }
    const std::string text = "!DILocation(line: " + std::to_string(std::max(p.line, 0)) +
                             ", column: " + std::to_string(std::clamp(p.column, 0, 65535)) + ", scope: " + scope_ + ")";
    const auto [known, is_new] = known_places_.try_emplace(text, static_cast<int>(metadata_.size()));
    if (is_new) add_metadata(text);
    return ", !dbg !" + std::to_string(known->second);
}

std::string Translator::translate_module() {
    collect_names();
    file_ = add_metadata("!DIFile(filename: " + quote_name(lines_.file.empty() ? path_ : lines_.file) +
                         ", directory: \"\")");
    unit_ = add_metadata("distinct !DICompileUnit(language: DW_LANG_C99, file: " + file_ +
                         ", producer: \"spirv\", isOptimized: false, runtimeVersion: 0, emissionKind: FullDebug)");
    const std::string version = add_metadata("!{i32 2, !\"Debug Info Version\", i32 3}");

    // Declares types and constants, and translates functions.
    std::size_t function_count = 0, next_variable = 0;
    for (std::size_t k = 0; k < instructions_.size(); ++k) {
        const SpirvInstruction& instruction = instructions_[k];
        if (instruction.op != "OpFunction") {
            declare(instruction);
            continue;
        }
        // The constants that variables hold may be declared after the variables.
        for (; next_variable < k && function_count == 0; ++next_variable)
            if (instructions_[next_variable].op == "OpVariable") declare_variable(instructions_[next_variable]);

        ++function_count;
        std::size_t end = k;
        while (end < instructions_.size() && instructions_[end].op != "OpFunctionEnd") ++end;
        if (end == instructions_.size()) instruction.fail("a function has no end");
        const std::string name = name_of(instruction.result);
        const bool is_main = !lines_.tokens.empty() && (name == "main" || name == "lb_main" || name == "lb_m");
        if (!is_main) translate_function(k, end);
        k = end;
    }
    if (functions_.empty()) throw InputError("the SPIR-V cannot be read: it defines no function");

    // Joins the parts of the module.
    std::string text;
    for (const std::vector<std::string>* part : {&definitions_, &body_})
        for (const std::string& text_line : *part) text += text_line + "\n";
    for (const std::string& text_line : declarations_) text += text_line + "\n";
    text += "!llvm.dbg.cu = !{" + unit_ + "}\n!llvm.module.flags = !{" + version + "}\n";
    for (std::size_t k = 0; k < metadata_.size(); ++k) text += "!" + std::to_string(k) + " = " + metadata_[k] + "\n";
    return text;
}

std::string source_file_name(const std::string& assembly) {
    const std::vector<SpirvInstruction> instructions = read_instructions(assembly);
    const auto line = std::ranges::find(instructions, "OpLine", &SpirvInstruction::op);
    if (line == instructions.end()) return "";
    const auto file = std::ranges::find(instructions, line->at(0), &SpirvInstruction::result);
    return file == instructions.end() || file->op != "OpString" ? "" : file->at(0);
}

std::string translate_to_llvm(const std::string& assembly, const std::string& path, const ShaderLines& lines,
                              bool has_opaque_pointers) {
    const std::vector<SpirvInstruction> instructions = read_instructions(assembly);
    return Translator(instructions, path, lines, has_opaque_pointers).translate_module();
}

}  // namespace lostbits::intersect::spirv
