// Types and names of a function, from its debug information.
#include <charconv>
#include <map>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/signature.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

std::size_t number_in(const std::string& digits) {
    std::size_t n = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), n);
    return n;
}

/// Name with the namespaces and classes around it.
std::string qualified(const Module& module, std::string_view text, SourceLanguage language) {
    std::string name = field(text, "name");
    int scope = reference(field(text, "scope"));
    for (int guard = 0; language == SourceLanguage::cpp && scope >= 0 && guard < 20; ++guard) {
        const std::string_view around = module.metadata(scope);
        const bool named = around.find("DINamespace") != std::string_view::npos ||
                           around.find("DICompositeType") != std::string_view::npos;
        const std::string outer = field(around, "name");
        if (!named) break;
        if (!outer.empty()) name.insert(0, outer + "::");
        scope = reference(field(around, "scope"));
    }
    return name;
}

SourceType type_of(const Module& module, int number, SourceLanguage language, int depth = 0) {
    if (number < 0) return {.kind = Kind::nothing, .name = "void"};
    const std::string_view text = module.metadata(number);
    const std::string tag = field(text, "tag");
    SourceType made{.name = qualified(module, text, language), .size = number_in(field(text, "size")) / 8};
    const auto inner = [&](const char* key = "baseType") {
        return type_of(module, reference(field(text, key)), language, depth + 1);
    };
    if (depth > 12) return made;
    if (text.find("DIBasicType") != std::string_view::npos) {
        const std::string encoding = field(text, "encoding");
        const bool is_number = encoding == "DW_ATE_float" && (made.size == 4 || made.size == 8);
        made.kind = is_number ? Kind::number : encoding == "DW_ATE_float" ? Kind::other : Kind::whole;
        if (made.name == "()") made.kind = Kind::nothing;
    } else if (tag == "DW_TAG_typedef" || tag == "DW_TAG_const_type" || tag == "DW_TAG_volatile_type" ||
               tag == "DW_TAG_restrict_type") {
        const std::string name = made.name;
        made = inner();
        if (tag == "DW_TAG_typedef") made.name = name;
        made.is_const = made.is_const || tag == "DW_TAG_const_type";
    } else if (tag == "DW_TAG_pointer_type" || tag == "DW_TAG_reference_type") {
        const bool is_reference = tag == "DW_TAG_reference_type";
        made.kind = Kind::pointer;
        made.parts = {inner()};
        if (language == SourceLanguage::rust)
            made.is_const = !made.name.starts_with("&mut") && !made.name.starts_with("*mut");
        else made.is_const = made.parts[0].is_const, made.name = is_reference ? "&" : "*";
        made.size = 8;
    } else if (tag == "DW_TAG_array_type") {
        made.kind = Kind::sequence, made.parts = {inner()}, made.count = 1;
        std::vector<std::size_t> counts;
        for (const int range : references(module.metadata(reference(field(text, "elements")))))
            counts.push_back(number_in(field(module.metadata(range), "count")));
        for (std::size_t k = counts.size(); k-- > 0;) {
            const std::size_t size = made.parts[0].size * counts[k];
            if (k + 1 < counts.size()) {
                SourceType outer{.kind = Kind::sequence, .name = {}, .size = made.size * counts[k], .count = counts[k]};
                outer.parts = {std::move(made)};
                made = std::move(outer);
            } else made.size = size, made.count = counts[k];
        }
    } else if (tag == "DW_TAG_structure_type" || tag == "DW_TAG_class_type") {
        made.kind = Kind::structure;
        if (language == SourceLanguage::c && !made.name.empty()) made.name.insert(0, "struct ");
        const bool is_optional = made.name.starts_with("Option<") || made.name.starts_with("std::optional<") ||
                                 made.name.find("::optional<") != std::string::npos;
        for (const int m : references(module.metadata(reference(field(text, "elements"))))) {
            const std::string_view member = module.metadata(m);
            const std::string kind = field(member, "tag");
            if (is_optional && language == SourceLanguage::rust && kind == "DW_TAG_variant_part") {
                for (const int v : references(module.metadata(reference(field(member, "elements"))))) {
                    const std::string_view variant = module.metadata(v);
                    if (field(variant, "name") != "Some") continue;
                    const SourceType some = type_of(module, reference(field(variant, "baseType")), language, depth + 1);
                    made.kind = Kind::optional;
                    made.parts = some.parts;
                }
                return made;
            }
            if ((kind != "DW_TAG_member" && kind != "DW_TAG_inheritance") ||
                member.find("DIFlagStaticMember") != std::string_view::npos)
                continue;
            SourceType part = type_of(module, reference(field(member, "baseType")), language, depth + 1);
            part.member = field(member, "name");
            part.at = number_in(field(member, "offset")) / 8;
            made.parts.push_back(std::move(part));
        }
        if (is_optional && language == SourceLanguage::cpp) {
            made.kind = Kind::optional;
            SourceType value;
            for (const int p : references(module.metadata(reference(field(text, "templateParams")))))
                value = type_of(module, reference(field(module.metadata(p), "type")), language, depth + 1);
            made.parts = {value};
        }
    } else if (tag == "DW_TAG_enumeration_type") {
        made.kind = Kind::whole;
    }
    return made;
}

}  // namespace

UserSignature signature_of(const Module& module, const std::string& path, const std::string& name,
                           SourceLanguage language) {
    // The definition whose debug information has the name; of several, the one with the whole name.
    const IrFunction* found = nullptr;
    const std::string last = name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1);
    std::string_view text;
    for (const auto& [symbol, f] : module.functions) {
        const std::string_view subprogram = module.metadata(f.subprogram);
        const std::string called = field(subprogram, "name");
        if (called != last && symbol != name && !called.starts_with(last + "<")) continue;
        if (found != nullptr && field(text, "linkageName").find(name) != std::string::npos) continue;
        found = &f;
        text = subprogram;
    }
    if (found == nullptr) throw InputError(path + ": has no function " + external::shown_text(name));
    UserSignature s;
    s.language = language;
    s.call = name;
    const std::vector<int> types =
        references(module.metadata(reference(field(module.metadata(reference(field(text, "type"))), "types"))));
    if (types.empty())
        throw InputError(path + ": the function " + name + " has no debug information; compile it with -g");
    s.returned = type_of(module, types[0], language);
    const auto is_of_function = [&](int scope) { return module.metadata(scope) == text; };
    std::map<std::size_t, std::string> names;
    bool has_this = false;
    for (int n = 0, misses = 0; misses < 4000; ++n) {
        const std::string_view variable = module.metadata(n);
        if (variable.empty()) {
            ++misses;
            continue;
        }
        misses = 0;
        if (variable.find("DILocalVariable") == std::string_view::npos) continue;
        const std::size_t arg = number_in(field(variable, "arg"));
        if (arg == 0 || !is_of_function(reference(field(variable, "scope")))) continue;
        names[arg] = field(variable, "name");
        has_this = has_this || (names[arg] == "this" && arg == 1) ||
                   (language == SourceLanguage::rust && names[arg] == "self");
    }
    s.is_method = has_this && language == SourceLanguage::cpp;
    for (std::size_t k = 1; k < types.size(); ++k) {
        Argument a{.name = names.contains(k) ? names[k] : "p" + std::to_string(k - 1),
                   .type = type_of(module, types[k], language)};
        a.is_this = k == 1 && has_this;
        s.arguments.push_back(std::move(a));
    }
    return s;
}

}  // namespace lostbits::intersect::function
