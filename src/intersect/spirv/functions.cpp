// Functions, their blocks, memory, and parts of values.
#include <algorithm>
#include <array>

#include "intersect/spirv/llvm_text.hpp"
#include "intersect/spirv/translator.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::spirv {
namespace {

std::string label(const std::string& id) { return "%b." + id; }

std::string symbol(const std::string& id) { return "@f." + id; }

bool is_chain(const SpirvInstruction& i) { return i.op == "OpAccessChain" || i.op == "OpInBoundsAccessChain"; }

}  // namespace

/// True for debug information that stands among the instructions, as of `glslangValidator -gV`.
bool Translator::is_note(const SpirvInstruction& i) const {
    if (i.op != "OpExtInst") return false;
    const auto set = strings_.find(i.at(1));
    return set != strings_.end() && set->second.starts_with("NonSemantic.");
}

/// True if the first access to the memory behind a parameter writes it: the function answers there.
bool Translator::is_written_first(std::size_t from, std::size_t end, const std::string& id) const {
    std::set<std::string> parts{id};
    for (std::size_t k = from; k < end; ++k) {
        const SpirvInstruction& i = all_[k];
        if (is_note(i)) continue;
        if (is_chain(i) && parts.contains(i.at(1))) parts.insert(i.result);
        else if (i.op == "OpStore" && parts.contains(i.at(0))) return true;
        else if (std::ranges::any_of(i.operands, [&](const std::string& o) { return parts.contains(o); })) return false;
    }
    return false;
}

/// Adds the parameters of a function to its values, and the debug information of each. Returns the list.
std::string Translator::parameters_of(std::size_t first, std::size_t end, const std::string& scope) {
    const SpirvType& type = type_of(all_[first].at(2), all_[first]);
    if (type.kind != Kind::function || type.parts.empty()) all_[first].fail("a function has no type");
    std::string list, notes = note_of(*type.parts[0]);
    std::size_t number = 0;
    for (std::size_t k = first + 1; k < end; ++k) {
        const SpirvInstruction& i = all_[k];
        if (i.op != "OpFunctionParameter") continue;
        const SpirvType& own = type_of(i.at(0), i);
        std::string its = note_of(own);
        if (own.kind == Kind::pointer && !is_written_first(k + 1, end, i.result))
            its = note("!DIDerivedType(tag: DW_TAG_reference_type, baseType: " +
                       note("!DIDerivedType(tag: DW_TAG_const_type, baseType: " + note_of(*own.parts[0]) + ")") +
                       ", size: 64)");
        values_[i.result] = {&own, "%s." + i.result, {}};
        list += (number++ == 0 ? "" : ", ") + values_[i.result].typed();
        notes += ", " + its;
        const std::string name = name_of(i.result);
        note("!DILocalVariable(name: " + quoted_name(name.empty() ? "p" + std::to_string(number - 1) : name) +
             ", arg: " + std::to_string(number) + ", scope: " + scope + ", file: " + file_ + ", type: " + its + ")");
    }
    if (number + 1 != type.parts.size()) all_[first].fail("the parameters of a function are not those of its type");
    metadata_.push_back("!DISubroutineType(types: " + note("!{" + notes + "}") + ")");
    return list;
}

void Translator::function(std::size_t first, std::size_t end) {
    const SpirvInstruction& head = all_[first];
    const SpirvType& returned = type_of(head.at(0), head);
    const bool is_defined =
        std::any_of(all_.begin() + static_cast<std::ptrdiff_t>(first), all_.begin() + static_cast<std::ptrdiff_t>(end),
                    [](const SpirvInstruction& i) { return i.op == "OpLabel"; });
    if (!is_defined) return;
    scope_ = note("");
    const std::size_t own = metadata_.size() - 1;
    const std::string list = parameters_of(first, end, scope_);
    const std::string types = "!" + std::to_string(metadata_.size() - 1), name = name_of(head.result);
    const int line = lines_.file.empty() ? head.line : places_.last().line;
    metadata_[own] = "distinct !DISubprogram(name: " + quoted_name(name.empty() ? head.result : name) +
                     ", scope: " + file_ + ", file: " + file_ + ", line: " + std::to_string(std::max(line, 0)) +
                     ", type: " + types + ", unit: " + unit_ + ", spFlags: DISPFlagDefinition)";
    body_.push_back("define internal " + returned.text + " " + symbol(head.result) + "(" + list + ") !dbg " + scope_ +
                    " {");
    places_.begin_function();
    known_places_.clear();
    for (std::size_t k = first + 1; k < end; ++k)
        if (all_[k].op != "OpFunctionParameter") instruction(all_[k]);
    resolve_phis();
    body_.push_back("}");
}

/// Writes the operands of phis, which may come later than the phi itself.
void Translator::resolve_phis() {
    for (const OpenPhi& phi : phis_) {
        const SpirvInstruction& i = *phi.instruction;
        std::string list;
        for (std::size_t k = 1; k + 1 < i.operands.size(); k += 2)
            list += (k == 1 ? " [ " : ", [ ") + value(i.at(k), i).text + ", " + label(i.at(k + 1)) + " ]";
        const std::size_t mark = body_[phi.line].find('#');
        body_[phi.line].replace(mark, 1, list);
    }
    phis_.clear();
}

TypedText Translator::value(const std::string& id, const SpirvInstruction& i) const {
    const auto found = values_.find(id);
    if (found == values_.end()) i.fail("%" + id + " is not a value");
    return found->second;
}

void Translator::line(const std::string& text) { body_.push_back("  " + text + place_); }

TypedText Translator::made(const SpirvType& type, const std::string& text) {
    const std::string name = "%t." + std::to_string(temporaries_++);
    line(name + " = " + text);
    return {&type, name, {}};
}

/// Calls the function that stands for something that cannot be followed.
TypedText Translator::refuse(const SpirvType& type, const std::string& sentence) {
    const std::string name = "@" + quoted_name(refusal + sentence) + "()";
    declarations_.insert("declare extern_weak void " + name);
    line("call void " + name);
    return {&type, "undef", {}};
}

void Translator::instruction(const SpirvInstruction& i) {
    constexpr std::array silent{"OpNop", "OpName", "OpSelectionMerge", "OpLoopMerge", "OpNoLine"};
    const auto place = [&](std::size_t k) { return static_cast<int>(std::clamp(wholes_[i.at(k)], 0.0, 0x1p30)); };
    if (i.op == "OpLine") return declare(i);
    if (is_note(i)) {
        if (i.at(2) == "DebugLine") places_.visit(place(4), place(6));
        return;
    }
    if (std::ranges::find(silent, i.op) != silent.end()) return;
    if (i.op == "OpLabel") {
        body_.push_back(label(i.result).substr(1) + ":");
        return;
    }
    place_ = place_now(i);
    if (i.op == "OpUndef") return declare(i);
    if (control(i)) return;
    for (const std::string& operand : i.operands) {
        const auto used = values_.find(operand);
        const bool reads = used != values_.end() && !used->second.refused.empty() && !is_chain(i);
        if (!reads) continue;
        const std::string why = used->second.refused;
        const SpirvType& type = i.result.empty() ? simple_type(Kind::integer, 32) : type_of(i.at(0), i);
        const TypedText none = refuse(type, why);
        if (!i.result.empty()) values_[i.result] = none;
        return;
    }
    if (memory(i) || composite(i) || matrix(i) || arithmetic(i)) return;
    if (i.result.empty())
        refuse(simple_type(Kind::integer, 32), "the instruction " + i.op + " of SPIR-V is not followed");
    else {
        const SpirvType& type = type_of(i.at(0), i);
        values_[i.result] = refuse(type, "the instruction " + i.op + " of SPIR-V is not followed");
        values_[i.result].type = &type;
    }
}

/// The end of a block, and phis.
bool Translator::control(const SpirvInstruction& i) {
    const auto target = [&](std::size_t k) { return "label " + label(i.at(k)); };
    if (i.op == "OpPhi") {
        const SpirvType& type = type_of(i.at(0), i);
        values_[i.result] = made(type, "phi " + type.text + "#");
        phis_.push_back({body_.size() - 1, &i});
    } else if (i.op == "OpBranch") line("br " + target(0));
    else if (i.op == "OpBranchConditional")
        line("br " + value(i.at(0), i).typed() + ", " + target(1) + ", " + target(2));
    else if (i.op == "OpSwitch") {
        const TypedText on = value(i.at(0), i);
        std::string cases;
        for (std::size_t k = 2; k + 1 < i.operands.size(); k += 2)
            cases += on.type->text + " " + i.at(k) + ", " + target(k + 1) + " ";
        line("switch " + on.typed() + ", " + target(1) + " [ " + cases + "]");
    } else if (i.op == "OpReturn") line("ret void");
    else if (i.op == "OpReturnValue") line("ret " + value(i.at(0), i).typed());
    else if (i.op == "OpUnreachable") line("unreachable");
    else if (i.op == "OpKill" || i.op == "OpTerminateInvocation") {
        refuse(simple_type(Kind::integer, 32), "it discards the fragment, which is not followed");
        line("unreachable");
    } else return false;
    return true;
}

/// A variable of a function, and its name in the debug information.
void Translator::variable(const SpirvInstruction& i) {
    const SpirvType& type = type_of(i.at(0), i);
    if (type.kind != Kind::pointer) i.fail("a variable has no address");
    const TypedText address = values_[i.result] = made(type, "alloca " + type.parts[0]->text);
    const std::string name = name_of(i.result);
    // glslang calls its own variables "param" and "indexable".
    if (!name.empty() && name != "param" && name != "indexable") {
        const std::string own = note("!DILocalVariable(name: " + quoted_name(name) + ", scope: " + scope_ +
                                     ", file: " + file_ + ", type: " + note_of(*type.parts[0]) + ")");
        declarations_.insert("declare void @llvm.dbg.declare(metadata, metadata, metadata)");
        line("call void @llvm.dbg.declare(metadata " + address.typed() + ", metadata " + own +
             ", metadata !DIExpression())");
    }
    if (i.operands.size() > 2) line("store " + value(i.at(2), i).typed() + ", " + address.typed());
}

/// The address of a part, or a refused address.
TypedText Translator::element(const SpirvInstruction& i) {
    const TypedText base = value(i.at(1), i);
    const SpirvType& type = type_of(i.at(0), i);
    if (base.type->kind != Kind::pointer) i.fail("an address is missing");
    std::string text = "getelementptr " + base.type->parts[0]->text + ", " + base.typed() + ", i32 0";
    for (std::size_t k = 2; k < i.operands.size(); ++k) text += ", " + value(i.at(k), i).typed();
    if (!base.refused.empty()) return {&type, "null", base.refused};
    return made(type, text);
}

TypedText Translator::call(const SpirvInstruction& i) {
    const SpirvType& type = type_of(i.at(0), i);
    const auto callee = functions_.find(i.at(1));
    if (callee == functions_.end()) i.fail("%" + i.at(1) + " is not a function");
    std::string list;
    for (std::size_t k = 2; k < i.operands.size(); ++k) list += (k == 2 ? "" : ", ") + value(i.at(k), i).typed();
    const std::string text = "call " + type.text + " " + symbol(i.at(1)) + "(" + list + ")";
    if (type.kind != Kind::nothing) return made(type, text);
    line(text);
    return {&type, "undef", {}};
}

bool Translator::memory(const SpirvInstruction& i) {
    if (i.op == "OpVariable") variable(i);
    else if (is_chain(i)) values_[i.result] = element(i);
    else if (i.op == "OpFunctionCall") values_[i.result] = call(i);
    else if (i.op == "OpLoad") {
        const SpirvType& type = type_of(i.at(0), i);
        values_[i.result] = made(type, "load " + type.text + ", " + value(i.at(1), i).typed());
    } else if (i.op == "OpStore") line("store " + value(i.at(1), i).typed() + ", " + value(i.at(0), i).typed());
    else if (i.op == "OpCopyMemory") {
        const TypedText from = value(i.at(1), i);
        if (from.type->kind != Kind::pointer) i.fail("an address is missing");
        const SpirvType& target = *from.type->parts[0];
        line("store " + made(target, "load " + target.text + ", " + from.typed()).typed() + ", " +
             value(i.at(0), i).typed());
    } else return false;
    return true;
}

// Parts

TypedText Translator::part(const TypedText& whole, std::size_t k) {
    const SpirvType* const found = whole.type->part(k);
    if (found == nullptr) throw InputError("the SPIR-V cannot be read: an index is outside of its type");
    const SpirvType& type = *found;
    const std::string index = std::to_string(k);
    if (whole.type->kind == Kind::vector) return made(type, "extractelement " + whole.typed() + ", i32 " + index);
    return made(type, "extractvalue " + whole.typed() + ", " + index);
}

TypedText Translator::with_part(const TypedText& whole, std::size_t k, const TypedText& part) {
    const std::string index = std::to_string(k);
    if (whole.type->kind == Kind::vector)
        return made(*whole.type, "insertelement " + whole.typed() + ", " + part.typed() + ", i32 " + index);
    return made(*whole.type, "insertvalue " + whole.typed() + ", " + part.typed() + ", " + index);
}

TypedText Translator::with_part(const TypedText& whole, const std::vector<std::size_t>& path, std::size_t at,
                                const TypedText& part) {
    if (at == path.size()) return part;
    return with_part(whole, path[at], with_part(this->part(whole, path[at]), path, at + 1, part));
}

/// A vector or another whole of these parts. Vectors among the parts of a vector give their lanes.
TypedText Translator::joined(const SpirvType& type, const Values& parts) {
    TypedText all{&type, "undef", {}};
    std::size_t next = 0;
    for (const TypedText& p : parts) {
        const bool is_split = type.kind == Kind::vector && p.type->kind == Kind::vector;
        const std::size_t count = is_split ? p.type->count : 1;
        for (std::size_t k = 0; k < count && type.part(next) != nullptr; ++k)
            all = with_part(all, next++, is_split ? part(p, k) : p);
    }
    return all;
}

bool Translator::composite(const SpirvInstruction& i) {
    const auto type = [&]() -> const SpirvType& { return type_of(i.at(0), i); };
    const auto index = [&](const SpirvType& whole, std::size_t k) {
        const std::size_t n =
            i.at(k).size() > 4 ? ~std::size_t{0} : static_cast<std::size_t>(std::atoi(i.at(k).c_str()));
        if (whole.part(n) == nullptr) i.fail("an index is outside of its type");
        return n;
    };
    if (i.op == "OpCompositeConstruct") {
        Values parts;
        for (std::size_t k = 1; k < i.operands.size(); ++k) parts.push_back(value(i.at(k), i));
        values_[i.result] = joined(type(), parts);
    } else if (i.op == "OpCompositeExtract") {
        TypedText found = value(i.at(1), i);
        for (std::size_t k = 2; k < i.operands.size(); ++k) found = part(found, index(*found.type, k));
        values_[i.result] = found;
    } else if (i.op == "OpCompositeInsert") {
        const TypedText whole = value(i.at(2), i);
        std::vector<std::size_t> path;
        const SpirvType* inside = whole.type;
        for (std::size_t k = 3; k < i.operands.size(); ++k) {
            path.push_back(index(*inside, k));
            inside = inside->part(path.back());
        }
        values_[i.result] = with_part(whole, path, 0, value(i.at(1), i));
    } else if (i.op == "OpVectorShuffle") {
        const TypedText a = value(i.at(1), i), b = value(i.at(2), i);
        Values lanes;
        for (std::size_t k = 3; k < i.operands.size(); ++k) {
            const std::size_t n =
                i.at(k).size() > 2 ? ~std::size_t{0} : static_cast<std::size_t>(std::atoi(i.at(k).c_str()));
            const bool first = n < a.type->count;
            if (n == ~std::size_t{0}) lanes.push_back({&a.lane(), "undef", {}});
            else if (!first && b.type->part(n - a.type->count) == nullptr) i.fail("an index is outside of its type");
            else lanes.push_back(part(first ? a : b, first ? n : n - a.type->count));
        }
        values_[i.result] = joined(type(), lanes);
    } else if (i.op == "OpVectorExtractDynamic") {
        values_[i.result] =
            made(type(), "extractelement " + value(i.at(1), i).typed() + ", " + value(i.at(2), i).typed());
    } else if (i.op == "OpVectorInsertDynamic") {
        values_[i.result] = made(type(), "insertelement " + value(i.at(1), i).typed() + ", " +
                                             value(i.at(2), i).typed() + ", " + value(i.at(3), i).typed());
    } else if (i.op == "OpCopyObject" || i.op == "OpCopyLogical") {
        const TypedText same = value(i.at(1), i);
        if (i.op == "OpCopyLogical" && same.type->kind == Kind::structure && same.type->text != type().text)
            return false;
        values_[i.result] = same;
    } else return false;
    return true;
}

}  // namespace lostbits::intersect::spirv
