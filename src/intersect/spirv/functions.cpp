// Translates functions, their blocks, accesses to memory, and parts of values.
#include <algorithm>
#include <array>

#include "intersect/spirv/llvm_text.hpp"
#include "intersect/spirv/translator.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::spirv {
namespace {

std::string label(const std::string& id) { return "%b." + id; }

std::string function_symbol(const std::string& id) { return "@f." + id; }

bool is_access_chain(const SpirvInstruction& instruction) {
    return instruction.op == "OpAccessChain" || instruction.op == "OpInBoundsAccessChain";
}

}  // namespace

/// True for debug information that stands among the instructions, as `glslangValidator -gV` writes it.
bool Translator::is_debug_info(const SpirvInstruction& instruction) const {
    if (instruction.op != "OpExtInst") return false;
    const auto set = strings_.find(instruction.at(1));
    return set != strings_.end() && set->second.starts_with("NonSemantic.");
}

/// True if the first access to the memory to which a parameter points writes it: the parameter then returns an answer.
bool Translator::is_written_first(std::size_t first, std::size_t end, const std::string& id) const {
    std::set<std::string> parts{id};
    for (std::size_t k = first; k < end; ++k) {
        const SpirvInstruction& instruction = instructions_[k];
        if (is_debug_info(instruction)) continue;
        if (is_access_chain(instruction) && parts.contains(instruction.at(1))) parts.insert(instruction.result);
        else if (instruction.op == "OpStore" && parts.contains(instruction.at(0))) return true;
        else if (std::ranges::any_of(instruction.operands, [&](const std::string& o) { return parts.contains(o); }))
            return false;
    }
    return false;
}

/// Adds the parameters of a function to its values, with the debug information of each parameter. Returns the list of
/// the parameters.
std::string Translator::translate_parameters(std::size_t first, std::size_t end, const std::string& scope) {
    const SpirvType& type = type_of(instructions_[first].at(2), instructions_[first]);
    if (type.kind != Kind::function || type.parts.empty()) instructions_[first].fail("a function has no type");

    std::string list, type_list = metadata_of(*type.parts[0]);
    std::size_t parameter_count = 0;
    for (std::size_t k = first + 1; k < end; ++k) {
        const SpirvInstruction& instruction = instructions_[k];
        if (instruction.op != "OpFunctionParameter") continue;

        // The target of a pointer is constant unless the function writes it first.
        const SpirvType& parameter_type = type_of(instruction.at(0), instruction);
        std::string type_metadata = metadata_of(parameter_type);
        if (parameter_type.kind == Kind::pointer && !is_written_first(k + 1, end, instruction.result))
            type_metadata = add_metadata("!DIDerivedType(tag: DW_TAG_reference_type, baseType: " +
                                         add_metadata("!DIDerivedType(tag: DW_TAG_const_type, baseType: " +
                                                      metadata_of(*parameter_type.parts[0]) + ")") +
                                         ", size: 64)");

        values_[instruction.result] = {&parameter_type, "%s." + instruction.result, {}};
        list += (parameter_count++ == 0 ? "" : ", ") + values_[instruction.result].typed();
        type_list += ", " + type_metadata;
        const std::string name = name_of(instruction.result);
        add_metadata(
            "!DILocalVariable(name: " + quote_name(name.empty() ? "p" + std::to_string(parameter_count - 1) : name) +
            ", arg: " + std::to_string(parameter_count) + ", scope: " + scope + ", file: " + file_ +
            ", type: " + type_metadata + ")");
    }

    if (parameter_count + 1 != type.parts.size())
        instructions_[first].fail("the parameters of a function are not those of its type");
    metadata_.push_back("!DISubroutineType(types: " + add_metadata("!{" + type_list + "}") + ")");
    return list;
}

void Translator::translate_function(std::size_t first, std::size_t end) {
    const SpirvInstruction& function_instruction = instructions_[first];
    const SpirvType& returned_type = type_of(function_instruction.at(0), function_instruction);
    const bool is_defined =
        std::any_of(instructions_.begin() + static_cast<std::ptrdiff_t>(first),
                    instructions_.begin() + static_cast<std::ptrdiff_t>(end),
                    [](const SpirvInstruction& instruction) { return instruction.op == "OpLabel"; });
    if (!is_defined) return;

    // The debug information of the function, whose index its parameters need before its text is known.
    scope_ = add_metadata("");
    const std::size_t subprogram_index = metadata_.size() - 1;
    const std::string list = translate_parameters(first, end, scope_);
    const std::string types = "!" + std::to_string(metadata_.size() - 1), name = name_of(function_instruction.result);
    const int line = lines_.file.empty() ? function_instruction.line : places_.last_visited().line;
    metadata_[subprogram_index] =
        "distinct !DISubprogram(name: " + quote_name(name.empty() ? function_instruction.result : name) +
        ", scope: " + file_ + ", file: " + file_ + ", line: " + std::to_string(std::max(line, 0)) + ", type: " + types +
        ", unit: " + unit_ + ", spFlags: DISPFlagDefinition)";

    // The function itself.
    body_.push_back("define internal " + returned_type.text + " " + function_symbol(function_instruction.result) + "(" +
                    list + ") !dbg " + scope_ + " {");
    places_.begin_function();
    known_places_.clear();
    for (std::size_t k = first + 1; k < end; ++k)
        if (instructions_[k].op != "OpFunctionParameter") translate_instruction(instructions_[k]);
    resolve_phis();
    body_.push_back("}");
}

/// Writes the operands of phis, which may be defined after the phi itself.
void Translator::resolve_phis() {
    for (const PendingPhi& phi : phis_) {
        const SpirvInstruction& instruction = *phi.instruction;
        std::string list;
        for (std::size_t k = 1; k + 1 < instruction.operands.size(); k += 2)
            list += (k == 1 ? " [ " : ", [ ") + value(instruction.at(k), instruction).text + ", " +
                    label(instruction.at(k + 1)) + " ]";
        const std::size_t placeholder = body_[phi.line].find('#');
        body_[phi.line].replace(placeholder, 1, list);
    }
    phis_.clear();
}

TypedText Translator::value(const std::string& id, const SpirvInstruction& instruction) const {
    const auto entry = values_.find(id);
    if (entry == values_.end()) instruction.fail("%" + id + " is not a value");
    return entry->second;
}

void Translator::emit_line(const std::string& text) { body_.push_back("  " + text + place_); }

TypedText Translator::emit(const SpirvType& type, const std::string& text) {
    const std::string name = "%t." + std::to_string(temporary_count_++);
    emit_line(name + " = " + text);
    return {&type, name, {}};
}

/// Emits a call of a function that does not exist. Its name contains the sentence about what cannot be followed, which
/// becomes the message if the walk reaches the call.
TypedText Translator::refuse(const SpirvType& type, const std::string& sentence) {
    const std::string name = "@" + quote_name(refusal_prefix + sentence) + "()";
    declarations_.insert("declare extern_weak void " + name);
    emit_line("call void " + name);
    return {&type, "undef", {}};
}

void Translator::translate_instruction(const SpirvInstruction& instruction) {
    constexpr std::array ignored{"OpNop", "OpName", "OpSelectionMerge", "OpLoopMerge", "OpNoLine"};
    const auto number = [&](std::size_t k) {
        return static_cast<int>(std::clamp(integer_constants_[instruction.at(k)], 0.0, 0x1p30));
    };
    if (instruction.op == "OpLine") return declare(instruction);
    if (is_debug_info(instruction)) {
        // Its operands from 3 on: source, first line, last line, first column, last column.
        if (instruction.at(2) == "DebugLine") places_.visit(number(4), number(6));
        return;
    }

    if (std::ranges::find(ignored, instruction.op) != ignored.end()) return;
    if (instruction.op == "OpLabel") {
        body_.push_back(label(instruction.result).substr(1) + ":");
        return;
    }
    place_ = debug_suffix(instruction);
    if (instruction.op == "OpUndef") return declare(instruction);
    if (translate_control(instruction)) return;
    if (refuse_unreadable_operand(instruction)) return;
    if (translate_memory(instruction) || translate_composite(instruction) || translate_matrix(instruction) ||
        translate_arithmetic(instruction))
        return;

    // An instruction without a counterpart.
    if (instruction.result.empty())
        refuse(integer_type(Kind::integer, 32), "the instruction " + instruction.op + " of SPIR-V is not followed");
    else {
        const SpirvType& type = type_of(instruction.at(0), instruction);
        values_[instruction.result] = refuse(type, "the instruction " + instruction.op + " of SPIR-V is not followed");
        values_[instruction.result].type = &type;
    }
}

/// Refuses an instruction that reads an address that cannot be read. Returns false for other instructions.
bool Translator::refuse_unreadable_operand(const SpirvInstruction& instruction) {
    if (is_access_chain(instruction)) return false;
    for (const std::string& operand : instruction.operands) {
        const auto operand_value = values_.find(operand);
        if (operand_value == values_.end() || operand_value->second.refusal_reason.empty()) continue;
        const std::string reason = operand_value->second.refusal_reason;
        const SpirvType& type =
            instruction.result.empty() ? integer_type(Kind::integer, 32) : type_of(instruction.at(0), instruction);
        const TypedText undefined = refuse(type, reason);
        if (!instruction.result.empty()) values_[instruction.result] = undefined;
        return true;
    }
    return false;
}

/// Translates phis and the instructions that end a block. Returns false for other instructions.
bool Translator::translate_control(const SpirvInstruction& instruction) {
    const auto target = [&](std::size_t k) { return "label " + label(instruction.at(k)); };
    if (instruction.op == "OpPhi") {
        const SpirvType& type = type_of(instruction.at(0), instruction);
        values_[instruction.result] = emit(type, "phi " + type.text + "#");
        phis_.push_back({body_.size() - 1, &instruction});
    } else if (instruction.op == "OpBranch") emit_line("br " + target(0));
    else if (instruction.op == "OpBranchConditional")
        emit_line("br " + value(instruction.at(0), instruction).typed() + ", " + target(1) + ", " + target(2));
    else if (instruction.op == "OpSwitch") {
        const TypedText selector = value(instruction.at(0), instruction);
        std::string cases;
        for (std::size_t k = 2; k + 1 < instruction.operands.size(); k += 2)
            cases += selector.type->text + " " + instruction.at(k) + ", " + target(k + 1) + " ";
        emit_line("switch " + selector.typed() + ", " + target(1) + " [ " + cases + "]");
    } else if (instruction.op == "OpReturn") emit_line("ret void");
    else if (instruction.op == "OpReturnValue") emit_line("ret " + value(instruction.at(0), instruction).typed());
    else if (instruction.op == "OpUnreachable") emit_line("unreachable");
    else if (instruction.op == "OpKill" || instruction.op == "OpTerminateInvocation") {
        refuse(integer_type(Kind::integer, 32), "it discards the fragment, which is not followed");
        emit_line("unreachable");
    } else return false;
    return true;
}

/// Translates a variable of a function, and adds its name to the debug information.
void Translator::translate_variable(const SpirvInstruction& instruction) {
    const SpirvType& type = type_of(instruction.at(0), instruction);
    if (type.kind != Kind::pointer) instruction.fail("a variable has no address");
    const TypedText address = values_[instruction.result] = emit(type, "alloca " + type.parts[0]->text);
    const std::string name = name_of(instruction.result);
    // glslang calls its own variables "param" and "indexable".
    if (!name.empty() && name != "param" && name != "indexable") {
        const std::string variable_metadata =
            add_metadata("!DILocalVariable(name: " + quote_name(name) + ", scope: " + scope_ + ", file: " + file_ +
                         ", type: " + metadata_of(*type.parts[0]) + ")");
        declarations_.insert("declare void @llvm.dbg.declare(metadata, metadata, metadata)");
        emit_line("call void @llvm.dbg.declare(metadata " + address.typed() + ", metadata " + variable_metadata +
                  ", metadata !DIExpression())");
    }
    if (instruction.operands.size() > 2)
        emit_line("store " + value(instruction.at(2), instruction).typed() + ", " + address.typed());
}

/// Returns the address of a part. A part of an address that cannot be read cannot be read either.
TypedText Translator::emit_element_address(const SpirvInstruction& instruction) {
    const TypedText base = value(instruction.at(1), instruction);
    const SpirvType& type = type_of(instruction.at(0), instruction);
    if (base.type->kind != Kind::pointer) instruction.fail("an address is missing");
    std::string text = "getelementptr " + base.type->parts[0]->text + ", " + base.typed() + ", i32 0";
    for (std::size_t k = 2; k < instruction.operands.size(); ++k)
        text += ", " + value(instruction.at(k), instruction).typed();
    if (!base.refusal_reason.empty()) return {&type, "null", base.refusal_reason};
    return emit(type, text);
}

TypedText Translator::translate_call(const SpirvInstruction& instruction) {
    const SpirvType& type = type_of(instruction.at(0), instruction);
    const auto callee = functions_.find(instruction.at(1));
    if (callee == functions_.end()) instruction.fail("%" + instruction.at(1) + " is not a function");
    std::string list;
    for (std::size_t k = 2; k < instruction.operands.size(); ++k)
        list += (k == 2 ? "" : ", ") + value(instruction.at(k), instruction).typed();
    const std::string text = "call " + type.text + " " + function_symbol(instruction.at(1)) + "(" + list + ")";
    if (type.kind != Kind::void_type) return emit(type, text);
    emit_line(text);
    return {&type, "undef", {}};
}

bool Translator::translate_memory(const SpirvInstruction& instruction) {
    if (instruction.op == "OpVariable") translate_variable(instruction);
    else if (is_access_chain(instruction)) values_[instruction.result] = emit_element_address(instruction);
    else if (instruction.op == "OpFunctionCall") values_[instruction.result] = translate_call(instruction);
    else if (instruction.op == "OpLoad") {
        const SpirvType& type = type_of(instruction.at(0), instruction);
        values_[instruction.result] =
            emit(type, "load " + type.text + ", " + value(instruction.at(1), instruction).typed());
    } else if (instruction.op == "OpStore")
        emit_line("store " + value(instruction.at(1), instruction).typed() + ", " +
                  value(instruction.at(0), instruction).typed());
    else if (instruction.op == "OpCopyMemory") {
        const TypedText source = value(instruction.at(1), instruction);
        if (source.type->kind != Kind::pointer) instruction.fail("an address is missing");
        const SpirvType& target = *source.type->parts[0];
        emit_line("store " + emit(target, "load " + target.text + ", " + source.typed()).typed() + ", " +
                  value(instruction.at(0), instruction).typed());
    } else return false;
    return true;
}

// Parts

TypedText Translator::extract_part(const TypedText& whole, std::size_t k) {
    const SpirvType* const part_type = whole.type->part(k);
    if (part_type == nullptr) throw InputError("the SPIR-V cannot be read: an index is outside of its type");
    const SpirvType& type = *part_type;
    const std::string index = std::to_string(k);
    if (whole.type->kind == Kind::vector) return emit(type, "extractelement " + whole.typed() + ", i32 " + index);
    return emit(type, "extractvalue " + whole.typed() + ", " + index);
}

TypedText Translator::insert_part(const TypedText& whole, std::size_t k, const TypedText& part) {
    const std::string index = std::to_string(k);
    if (whole.type->kind == Kind::vector)
        return emit(*whole.type, "insertelement " + whole.typed() + ", " + part.typed() + ", i32 " + index);
    return emit(*whole.type, "insertvalue " + whole.typed() + ", " + part.typed() + ", " + index);
}

TypedText Translator::insert_part(const TypedText& whole, const std::vector<std::size_t>& path, std::size_t depth,
                                  const TypedText& part) {
    if (depth == path.size()) return part;
    return insert_part(whole, path[depth], insert_part(this->extract_part(whole, path[depth]), path, depth + 1, part));
}

/// A vector or another composite of these parts. Vectors among the parts of a vector contribute their lanes.
TypedText Translator::construct(const SpirvType& type, const Values& parts) {
    TypedText result{&type, "undef", {}};
    std::size_t next_index = 0;
    for (const TypedText& p : parts) {
        const bool is_split = type.kind == Kind::vector && p.type->kind == Kind::vector;
        const std::size_t count = is_split ? p.type->count : 1;
        for (std::size_t k = 0; k < count && type.part(next_index) != nullptr; ++k)
            result = insert_part(result, next_index++, is_split ? extract_part(p, k) : p);
    }
    return result;
}

/// Returns the lanes that a shuffle takes. Indices count the lanes of the first vector, then those of the second.
Translator::Values Translator::shuffle_lanes(const SpirvInstruction& instruction) {
    const TypedText a = value(instruction.at(1), instruction), b = value(instruction.at(2), instruction);
    Values lanes;
    for (std::size_t k = 3; k < instruction.operands.size(); ++k) {
        // Lanes have indices of one or two digits; 4294967295 stands for a lane without a value.
        constexpr std::size_t max_digits = 2;
        const std::size_t n = instruction.at(k).size() > max_digits
                                  ? ~std::size_t{0}
                                  : static_cast<std::size_t>(std::atoi(instruction.at(k).c_str()));
        const bool is_in_first = n < a.type->count;
        if (n == ~std::size_t{0}) lanes.push_back({&a.lane(), "undef", {}});
        else if (!is_in_first && b.type->part(n - a.type->count) == nullptr)
            instruction.fail("an index is outside of its type");
        else lanes.push_back(extract_part(is_in_first ? a : b, is_in_first ? n : n - a.type->count));
    }
    return lanes;
}

bool Translator::translate_composite(const SpirvInstruction& instruction) {
    const auto type = [&]() -> const SpirvType& { return type_of(instruction.at(0), instruction); };
    const auto index = [&](const SpirvType& composite, std::size_t k) {
        // An index of more digits is outside of every type.
        constexpr std::size_t max_digits = 4;
        const std::size_t n = instruction.at(k).size() > max_digits
                                  ? ~std::size_t{0}
                                  : static_cast<std::size_t>(std::atoi(instruction.at(k).c_str()));
        if (composite.part(n) == nullptr) instruction.fail("an index is outside of its type");
        return n;
    };

    // Parts of composites, then lanes of vectors, then copies.
    if (instruction.op == "OpCompositeConstruct") {
        Values parts;
        for (std::size_t k = 1; k < instruction.operands.size(); ++k)
            parts.push_back(value(instruction.at(k), instruction));
        values_[instruction.result] = construct(type(), parts);
    } else if (instruction.op == "OpCompositeExtract") {
        TypedText selected = value(instruction.at(1), instruction);
        for (std::size_t k = 2; k < instruction.operands.size(); ++k)
            selected = extract_part(selected, index(*selected.type, k));
        values_[instruction.result] = selected;
    } else if (instruction.op == "OpCompositeInsert") {
        const TypedText composite = value(instruction.at(2), instruction);
        std::vector<std::size_t> path;
        const SpirvType* part_type = composite.type;
        for (std::size_t k = 3; k < instruction.operands.size(); ++k) {
            path.push_back(index(*part_type, k));
            part_type = part_type->part(path.back());
        }
        values_[instruction.result] = insert_part(composite, path, 0, value(instruction.at(1), instruction));
    } else if (instruction.op == "OpVectorShuffle") {
        values_[instruction.result] = construct(type(), shuffle_lanes(instruction));
    } else if (instruction.op == "OpVectorExtractDynamic") {
        values_[instruction.result] = emit(type(), "extractelement " + value(instruction.at(1), instruction).typed() +
                                                       ", " + value(instruction.at(2), instruction).typed());
    } else if (instruction.op == "OpVectorInsertDynamic") {
        values_[instruction.result] = emit(type(), "insertelement " + value(instruction.at(1), instruction).typed() +
                                                       ", " + value(instruction.at(2), instruction).typed() + ", " +
                                                       value(instruction.at(3), instruction).typed());
    } else if (instruction.op == "OpCopyObject" || instruction.op == "OpCopyLogical") {
        const TypedText source = value(instruction.at(1), instruction);
        if (instruction.op == "OpCopyLogical" && source.type->kind == Kind::structure &&
            source.type->text != type().text)
            return false;
        values_[instruction.result] = source;
    } else return false;
    return true;
}

}  // namespace lostbits::intersect::spirv
