// Types and names of a function, from its debug information.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/common_names.hpp"
#include "intersect/function/signature.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

std::size_t parse_integer(const std::string& digits) {
    std::size_t n = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), n);
    return n;
}

/// Returns the name with the namespaces and classes that enclose it.
std::string qualified_name(const Module& module, std::string_view text, SourceLanguage language) {
    std::string name = metadata_field(text, "name");
    int scope = metadata_index(metadata_field(text, "scope"));
    for (int guard = 0; language == SourceLanguage::cpp && scope >= 0 && guard < 20; ++guard) {
        const std::string_view enclosing_scope = module.metadata(scope);
        const bool has_name = enclosing_scope.find("DINamespace") != std::string_view::npos ||
                              enclosing_scope.find("DICompositeType") != std::string_view::npos;
        const std::string outer = metadata_field(enclosing_scope, "name");
        if (!has_name) break;
        if (!outer.empty()) name.insert(0, outer + "::");
        scope = metadata_index(metadata_field(enclosing_scope, "scope"));
    }
    return name;
}

/// Reads a type by the index of its metadata node. Two kinds of types stay `other`: a type inside itself, and every
/// type after the first 5000. No type of a ray has so many parts, but the types of a whole program may refer to each
/// other in more ways than can be followed.
class TypeReader {
public:
    TypeReader(const Module& module, SourceLanguage language) : module_(module), language_(language) {}
    SourceType read_type(int node_index);

private:
    SourceType read_details(std::string_view text, SourceType source_type);
    SourceType read_array(std::string_view text, SourceType source_type);
    void add_members(std::string_view text, SourceType& source_type);
    void read_rust_option(std::string_view variants, SourceType& source_type);

    const Module& module_;
    SourceLanguage language_;
    std::vector<int> open_types_ = {};  ///< types that are being read
    int types_left_ = 5000;
};

SourceType TypeReader::read_type(int node_index) {
    if (node_index < 0) return {.kind = Kind::nothing, .name = "void"};
    const std::string_view text = module_.metadata(node_index);
    SourceType source_type{.name = qualified_name(module_, text, language_),
                           .size = parse_integer(metadata_field(text, "size")) / 8};
    if (open_types_.size() > 12 || std::ranges::find(open_types_, node_index) != open_types_.end() || --types_left_ < 0)
        return source_type;
    open_types_.push_back(node_index);
    source_type = read_details(text, std::move(source_type));
    open_types_.pop_back();
    return source_type;
}

SourceType TypeReader::read_details(std::string_view text, SourceType source_type) {
    const std::string tag = metadata_field(text, "tag");
    const auto inner = [&] { return read_type(metadata_index(metadata_field(text, "baseType"))); };
    if (text.find("DIBasicType") != std::string_view::npos) {
        const std::string encoding = metadata_field(text, "encoding");
        const bool is_float = encoding == "DW_ATE_float" && (source_type.size == 4 || source_type.size == 8);
        source_type.kind = is_float ? Kind::number : encoding == "DW_ATE_float" ? Kind::other : Kind::integer;
        if (source_type.name == "()") source_type.kind = Kind::nothing;
        return source_type;
    }

    // Other names and qualifiers of a type.
    if (tag == "DW_TAG_typedef" || tag == "DW_TAG_const_type" || tag == "DW_TAG_volatile_type" ||
        tag == "DW_TAG_restrict_type") {
        const std::string name = source_type.name;
        source_type = inner();
        if (tag == "DW_TAG_typedef") source_type.name = name;
        source_type.is_const = source_type.is_const || tag == "DW_TAG_const_type";
        return source_type;
    }

    // Pointers. In Rust, the name says whether the target is constant.
    if (tag == "DW_TAG_pointer_type" || tag == "DW_TAG_reference_type") {
        source_type.kind = Kind::pointer;
        source_type.parts = {inner()};
        source_type.size = 8;
        if (language_ == SourceLanguage::rust) {
            source_type.is_const = !source_type.name.starts_with("&mut") && !source_type.name.starts_with("*mut");
        } else {
            source_type.is_const = source_type.parts[0].is_const;
            source_type.name = tag == "DW_TAG_reference_type" ? "&" : "*";
        }
        return source_type;
    }

    // Types with parts.
    if (tag == "DW_TAG_array_type") return read_array(text, std::move(source_type));
    if (tag == "DW_TAG_structure_type" || tag == "DW_TAG_class_type") add_members(text, source_type);
    if (tag == "DW_TAG_enumeration_type") source_type.kind = Kind::integer;
    return source_type;
}

/// Reads an array. An array of several dimensions is an array of arrays.
SourceType TypeReader::read_array(std::string_view text, SourceType source_type) {
    source_type.kind = Kind::sequence;
    source_type.parts = {read_type(metadata_index(metadata_field(text, "baseType")))};
    source_type.count = 1;
    std::vector<std::size_t> counts;
    for (const int range : metadata_indices(module_.metadata(metadata_index(metadata_field(text, "elements")))))
        counts.push_back(parse_integer(metadata_field(module_.metadata(range), "count")));

    for (std::size_t k = counts.size(); k-- > 0;) {
        if (k + 1 == counts.size()) {
            source_type.size = source_type.parts[0].size * counts[k];
            source_type.count = counts[k];
            continue;
        }
        SourceType outer{.kind = Kind::sequence, .name = {}, .size = source_type.size * counts[k], .count = counts[k]};
        outer.parts = {std::move(source_type)};
        source_type = std::move(outer);
    }
    return source_type;
}

void TypeReader::add_members(std::string_view text, SourceType& source_type) {
    source_type.kind = Kind::structure;
    if (language_ == SourceLanguage::c && !source_type.name.empty()) source_type.name.insert(0, "struct ");
    const bool is_optional = source_type.name.starts_with("Option<") ||
                             source_type.name.starts_with("std::optional<") ||
                             source_type.name.find("::optional<") != std::string::npos;

    for (const int m : metadata_indices(module_.metadata(metadata_index(metadata_field(text, "elements"))))) {
        const std::string_view member = module_.metadata(m);
        const std::string kind = metadata_field(member, "tag");
        if (is_optional && language_ == SourceLanguage::rust && kind == "DW_TAG_variant_part")
            return read_rust_option(member, source_type);
        if ((kind != "DW_TAG_member" && kind != "DW_TAG_inheritance") ||
            member.find("DIFlagStaticMember") != std::string_view::npos)
            continue;
        SourceType part = read_type(metadata_index(metadata_field(member, "baseType")));
        part.member = metadata_field(member, "name");
        part.offset = parse_integer(metadata_field(member, "offset")) / 8;
        source_type.parts.push_back(std::move(part));
    }

    // The flag of std::optional, which may be a member of a base class.
    for (const SourceType& type : source_type.parts) {
        const bool is_flag = type.member == "_M_engaged" || type.member == "__engaged_";
        if (type.flag_size == 0 && !is_flag) continue;
        source_type.flag_offset = type.flag_size > 0 ? type.offset + type.flag_offset : type.offset;
        source_type.flag_size = type.flag_size > 0 ? type.flag_size : 1;
    }

    // The type of the value of std::optional is the parameter of its template.
    if (is_optional && language_ == SourceLanguage::cpp) {
        source_type.kind = Kind::optional;
        SourceType value;
        for (const int p : metadata_indices(module_.metadata(metadata_index(metadata_field(text, "templateParams")))))
            value = read_type(metadata_index(metadata_field(module_.metadata(p), "type")));
        source_type.parts = {value};
    }
}

/// Reads an Option of Rust: the integer that tells its two variants apart, and the value of the variant Some.
void TypeReader::read_rust_option(std::string_view variants, SourceType& source_type) {
    const std::string_view flag = module_.metadata(metadata_index(metadata_field(variants, "discriminator")));
    source_type.flag_offset = parse_integer(metadata_field(flag, "offset")) / 8;
    source_type.flag_size = parse_integer(metadata_field(flag, "size")) / 8;
    for (const int v : metadata_indices(module_.metadata(metadata_index(metadata_field(variants, "elements"))))) {
        const std::string_view variant = module_.metadata(v);
        if (metadata_field(variant, "name") != "Some") continue;
        const SourceType some_type = read_type(metadata_index(metadata_field(variant, "baseType")));
        source_type.kind = Kind::optional;
        source_type.parts = some_type.parts;
    }
}

SourceType source_number(std::size_t size) {
    return {.kind = Kind::number, .name = size == 4 ? "float" : "double", .size = size};
}

/// Returns a type of LLVM IR as a type of the source, in which the members of structures have their indices as names.
SourceType source_type_of(const Type& type) {
    if (type.kind == Type::Kind::number) return source_number(type.size);
    SourceType result{.name = {}, .size = type.size};
    if (type.kind == Type::Kind::integer) result.kind = Kind::integer;
    if (type.kind == Type::Kind::nothing) result.kind = Kind::nothing;
    if (type.kind == Type::Kind::sequence) {
        result.kind = Kind::sequence;
        result.parts = {source_type_of(*type.parts[0])};
        result.count = type.count;
    }
    if (type.kind == Type::Kind::structure) {
        result.kind = Kind::structure;
        for (std::size_t k = 0; k < type.parts.size(); ++k) {
            result.parts.push_back(source_type_of(*type.parts[k]));
            result.parts.back().member = std::to_string(k);
            result.parts.back().offset = type.offsets[k];
        }
    }
    return result;
}

/// Size of the numbers in which a function computes.
std::size_t find_number_size(const IrFunction& function) {
    for (const Block& b : function.blocks)
        for (const std::string_view line : b.lines)
            if (line.find(" float ") != std::string_view::npos) return 4;
    return 8;
}

/// Reads the arguments and the result of a function without debug information from its LLVM IR.
void set_ir_types(UserSignature& signature, Module& module, const IrFunction& function, const std::string& path) {
    const auto type_of_text = [&module](std::string_view text) {
        Cursor cursor(text);
        return module.read_type(cursor);
    };
    const std::size_t default_size = find_number_size(function);
    for (const IrParameter& p : function.parameters) {
        const bool has_name = p.name.find_first_not_of("0123456789") != std::string::npos;
        Argument a{.name = has_name ? p.name : "p" + std::to_string(signature.arguments.size()),
                   .type = source_type_of(*p.type)};

        // An opaque pointer is assumed to point to numbers of the size in which the function computes.
        if (p.type->kind == Type::Kind::pointer) {
            const bool has_target_type = p.type_text.ends_with('*');
            const bool is_answer =
                is_one_of(normalise_name(a.name), {"t", "tout", "thit", "dist", "far", "hit", "u", "v"});
            a.type = {.kind = Kind::pointer, .name = "*", .size = 8, .is_const = !is_answer};
            const std::string_view target = p.type_text.substr(0, p.type_text.size() - (has_target_type ? 1 : 0));
            a.type.parts = {has_target_type ? source_type_of(*type_of_text(target)) : source_number(default_size)};
        }

        if (a.type.kind == Kind::sequence || a.type.kind == Kind::other ||
            p.text.find("sret") != std::string_view::npos)
            throw InputError(path + ": the function " + signature.call +
                             " takes parts of structures, whose meaning is only in debug "
                             "information; compile it with -g");
        signature.arguments.push_back(std::move(a));
    }
    signature.returned = source_type_of(*type_of_text(function.returned_text));
}

/// Returns the last part of a name with namespaces: `hit` of `Sphere::hit`.
std::string last_part_of(const std::string& name) {
    const std::size_t colon = name.rfind(':');
    return colon == std::string::npos ? name : name.substr(colon + 1);
}

/// Finds the definition whose debug information has a name, which may end in `@LINE`. A function with the whole name
/// takes precedence over one in another namespace.
const IrFunction& find_definition(const Module& module, const std::string& path, const std::string& name,
                                  SourceLanguage language) {
    const std::size_t at_sign = name.find('@');
    const std::string function_name = name.substr(0, at_sign),
                      chosen_line = at_sign == std::string::npos ? "" : name.substr(at_sign + 1);
    const std::string last_part = last_part_of(function_name);
    const auto match_quality = [&](std::string_view subprogram) {
        const bool may_be_cpp = language == SourceLanguage::llvm;  // LLVM IR may come from C++
        const std::string whole = qualified_name(module, subprogram, may_be_cpp ? SourceLanguage::cpp : language);
        return whole == function_name ? 2 : whole.ends_with("::" + function_name) ? 1 : 0;
    };

    const IrFunction* best_function = nullptr;
    std::string_view best_subprogram;
    std::string candidate_lines;
    bool is_overloaded = false;
    int best_quality = 0;
    for (const auto& [symbol, f] : module.functions) {
        const std::string_view subprogram = module.metadata(f.subprogram);
        const std::string source_name = metadata_field(subprogram, "name");
        if (source_name != last_part && symbol != function_name && !source_name.starts_with(last_part + "<")) continue;
        const std::string line = metadata_field(subprogram, "line");
        if (!chosen_line.empty() && line != chosen_line) continue;

        // Functions of shaders have only these names; functions of C++ also have a name for the linker.
        is_overloaded = is_overloaded || (best_function != nullptr && language == SourceLanguage::llvm &&
                                          metadata_field(subprogram, "linkageName").empty() &&
                                          metadata_field(best_subprogram, "line") != line);
        candidate_lines += (candidate_lines.empty() ? "" : ", ") + function_name + "@" + line;

        const int quality = match_quality(subprogram);
        if (best_function != nullptr &&
            (quality < best_quality ||
             (quality == best_quality &&
              metadata_field(best_subprogram, "linkageName").find(function_name) != std::string::npos)))
            continue;
        best_function = &f;
        best_subprogram = subprogram;
        best_quality = quality;
    }

    if (best_function == nullptr) throw InputError(describe_missing_function(module.text(), path, name, language));
    if (is_overloaded)
        throw InputError(path + ": has several functions " + external::quote_text(function_name) +
                         "; name one by its line: " + candidate_lines);
    return *best_function;
}

SourceLanguage language_of_unit(const Module& module, std::string_view subprogram) {
    const std::string_view unit = module.metadata(metadata_index(metadata_field(subprogram, "unit")));
    return unit.find("DW_LANG_Rust") != std::string_view::npos          ? SourceLanguage::rust
           : unit.find("DW_LANG_C_plus_plus") != std::string_view::npos ? SourceLanguage::cpp
                                                                        : SourceLanguage::c;
}

/// Finds the names of a function's arguments, by their positions from 1.
std::map<std::size_t, std::string> find_argument_names(const Module& module, std::string_view subprogram) {
    constexpr int max_misses = 4000;  // metadata has gaps where an index is not used
    std::map<std::size_t, std::string> names;
    for (int n = 0, misses = 0; misses < max_misses; ++n) {
        const std::string_view variable = module.metadata(n);
        if (variable.empty()) {
            ++misses;
            continue;
        }
        misses = 0;
        if (variable.find("DILocalVariable") == std::string_view::npos) continue;
        const std::size_t arg = parse_integer(metadata_field(variable, "arg"));
        if (arg == 0 || module.metadata(metadata_index(metadata_field(variable, "scope"))) != subprogram) continue;
        names[arg] = metadata_field(variable, "name");
    }
    return names;
}

}  // namespace

int count_numbers(const SourceType& type, std::size_t& size, std::string& last_member) {
    if (type.kind == Kind::number) {
        if (size != 0 && size != type.size) return -1;
        size = type.size;
        last_member = normalise_name(type.member);
        return 1;
    }

    if (type.kind == Kind::sequence) {
        std::string unused;
        const int part_count = count_numbers(type.parts[0], size, unused);
        return part_count < 0 || part_count > 64 || type.count > 64 ? -1 : part_count * static_cast<int>(type.count);
    }

    if (type.kind != Kind::structure || type.parts.empty()) return -1;
    int total = 0;
    for (const SourceType& p : type.parts) {
        const int part_count = count_numbers(p, size, last_member);
        if (part_count < 0 || total > 4096) return -1;
        total += part_count;
    }
    return total;
}

bool is_sequence_of_numbers(const SourceType& type) {
    if (type.kind == Kind::sequence) return type.parts[0].kind == Kind::number;
    if (type.kind != Kind::structure) return false;
    if (type.parts.size() == 1) return is_sequence_of_numbers(type.parts[0]) || type.parts[0].kind == Kind::number;
    return std::ranges::all_of(type.parts, [](const SourceType& part) { return part.kind == Kind::number; });
}

bool contains_word(const std::string& source, const std::string& name) {
    const std::string untemplated_name = name.substr(0, name.find('<'));
    const std::string last_part = last_part_of(untemplated_name);
    const auto is_word_character = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    for (std::size_t position = source.find(last_part); position != std::string::npos;
         position = source.find(last_part, position + 1)) {
        const std::size_t end = position + last_part.size();
        if ((position == 0 || !is_word_character(source[position - 1])) &&
            (end == source.size() || !is_word_character(source[end])))
            return true;
    }
    return false;
}

std::string part_text(const Argument& argument, std::size_t offset) {
    const bool is_pointer = argument.type.kind == Kind::pointer && argument.type.name == "*";
    std::string text = argument.name;
    const SourceType* type = &argument.target();
    if (is_pointer && type->kind == Kind::number && type->size > 0)
        return text + "[" + std::to_string(offset / type->size) + "]";

    // Follows the items and members that contain the number.
    for (bool is_first = true; type != nullptr; is_first = false) {
        const SourceType* next = nullptr;
        if (type->kind == Kind::sequence && type->parts[0].size > 0) {
            next = type->parts.data();
            text += "[" + std::to_string(offset / next->size) + "]";
            offset %= next->size;
        } else if (type->kind == Kind::structure) {
            for (const SourceType& p : type->parts)
                if (offset >= p.offset && offset < p.offset + p.size) next = &p;
            if (next == nullptr) break;
            if (!next->member.empty()) text += (is_pointer && is_first ? "->" : ".") + next->member;
            offset -= next->offset;
        }
        type = next;
    }
    return text;
}

std::string describe_missing_function(const std::string& ir, const std::string& path, const std::string& name,
                                      SourceLanguage language) {
    constexpr std::size_t max_listed = 12;
    std::set<std::string> names;
    if (ir.find("define ") != std::string::npos) {
        const Module module(ir);
        for (const auto& [symbol, f] : module.functions) {
            const std::string_view text = module.metadata(f.subprogram);
            const std::filesystem::path file =
                metadata_field(module.metadata(metadata_index(metadata_field(text, "file"))), "filename");
            if (language != SourceLanguage::llvm && file.filename() != std::filesystem::path(path).filename()) continue;
            names.insert(text.empty() ? symbol : qualified_name(module, text, language));
        }
    }

    // Lists the first of the names.
    std::string text = names.empty() ? "; it defines none" : "";
    std::size_t listed = 0;
    for (const std::string& function_name : names) {
        if (listed++ < max_listed)
            text += (text.empty() ? "; it defines " : ", ") + external::quote_text(function_name);
    }
    if (listed > max_listed) text += " and " + std::to_string(listed - max_listed) + " more";
    return path + ": has no function " + external::quote_text(name) + text;
}

UserSignature read_signature(Module& module, const std::string& path, const std::string& name,
                             SourceLanguage language) {
    const IrFunction& definition = find_definition(module, path, name, language);
    const std::string_view subprogram = module.metadata(definition.subprogram);
    UserSignature signature;
    signature.language = language;
    signature.call = name.substr(0, name.find('@'));
    signature.symbol = definition.name;
    signature.line = static_cast<int>(parse_integer(metadata_field(subprogram, "line")));

    // LLVM IR may have no debug information, and may come from any of the other languages.
    if (language == SourceLanguage::llvm) {
        if (definition.subprogram < 0) {
            set_ir_types(signature, module, definition, path);
            return signature;
        }
        language = language_of_unit(module, subprogram);
        const std::string_view file = module.metadata(metadata_index(metadata_field(subprogram, "file")));
        signature.folder = (std::filesystem::path(metadata_field(file, "directory")) / metadata_field(file, "filename"))
                               .parent_path()
                               .string();
    }

    // The types of the result and of the arguments.
    const std::vector<int> types = metadata_indices(module.metadata(
        metadata_index(metadata_field(module.metadata(metadata_index(metadata_field(subprogram, "type"))), "types"))));
    if (types.empty())
        throw InputError(path + ": the function " + name + " has no debug information; compile it with -g");
    signature.returned = TypeReader(module, language).read_type(types[0]);
    const std::map<std::size_t, std::string> names = find_argument_names(module, subprogram);
    const bool has_this = std::ranges::any_of(names, [&](const auto& entry) {
        return (entry.second == "this" && entry.first == 1) ||
               (language == SourceLanguage::rust && entry.second == "self");
    });
    signature.is_method = has_this && language == SourceLanguage::cpp;
    for (std::size_t k = 1; k < types.size(); ++k) {
        Argument a{.name = names.contains(k) ? names.at(k) : "p" + std::to_string(k - 1),
                   .type = TypeReader(module, language).read_type(types[k])};
        a.is_this = k == 1 && has_this;
        signature.arguments.push_back(std::move(a));
    }
    return signature;
}

}  // namespace lostbits::intersect::function
