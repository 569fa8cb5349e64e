// Types and names of a function, from its debug information.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/common_names.hpp"
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

/// A type by its number. A type inside itself is unknown, and so are all after the first thousands: a ray has no such
/// type, and a program's types may lead to each other on more ways than can be followed.
class TypeReader {
public:
    TypeReader(const Module& module, SourceLanguage language) : module_(module), language_(language) {}
    SourceType type(int number);

private:
    SourceType known_type(std::string_view text, SourceType made);
    void add_members(std::string_view text, SourceType& made);

    const Module& module_;
    SourceLanguage language_;
    std::vector<int> around_ = {};  ///< types that are being read
    int left_ = 5000;
};

SourceType TypeReader::type(int number) {
    if (number < 0) return {.kind = Kind::nothing, .name = "void"};
    const std::string_view text = module_.metadata(number);
    SourceType made{.name = qualified(module_, text, language_), .size = number_in(field(text, "size")) / 8};
    if (around_.size() > 12 || std::ranges::find(around_, number) != around_.end() || --left_ < 0) return made;
    around_.push_back(number);
    made = known_type(text, std::move(made));
    around_.pop_back();
    return made;
}

SourceType TypeReader::known_type(std::string_view text, SourceType made) {
    const std::string tag = field(text, "tag");
    const auto inner = [&] { return type(reference(field(text, "baseType"))); };
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
        if (language_ == SourceLanguage::rust)
            made.is_const = !made.name.starts_with("&mut") && !made.name.starts_with("*mut");
        else made.is_const = made.parts[0].is_const, made.name = is_reference ? "&" : "*";
        made.size = 8;
    } else if (tag == "DW_TAG_array_type") {
        made.kind = Kind::sequence, made.parts = {inner()}, made.count = 1;
        std::vector<std::size_t> counts;
        for (const int range : references(module_.metadata(reference(field(text, "elements")))))
            counts.push_back(number_in(field(module_.metadata(range), "count")));
        for (std::size_t k = counts.size(); k-- > 0;) {
            const std::size_t size = made.parts[0].size * counts[k];
            if (k + 1 < counts.size()) {
                SourceType outer{.kind = Kind::sequence, .name = {}, .size = made.size * counts[k], .count = counts[k]};
                outer.parts = {std::move(made)};
                made = std::move(outer);
            } else made.size = size, made.count = counts[k];
        }
    } else if (tag == "DW_TAG_structure_type" || tag == "DW_TAG_class_type") {
        add_members(text, made);
    } else if (tag == "DW_TAG_enumeration_type") {
        made.kind = Kind::whole;
    }
    return made;
}

void TypeReader::add_members(std::string_view text, SourceType& made) {
    const auto offset_and_size = [this](int member) {
        const std::string_view m = module_.metadata(member);
        return std::pair(number_in(field(m, "offset")) / 8, number_in(field(m, "size")) / 8);
    };
    made.kind = Kind::structure;
    if (language_ == SourceLanguage::c && !made.name.empty()) made.name.insert(0, "struct ");
    const bool is_optional = made.name.starts_with("Option<") || made.name.starts_with("std::optional<") ||
                             made.name.find("::optional<") != std::string::npos;
    for (const int m : references(module_.metadata(reference(field(text, "elements"))))) {
        const std::string_view member = module_.metadata(m);
        const std::string kind = field(member, "tag");
        if (is_optional && language_ == SourceLanguage::rust && kind == "DW_TAG_variant_part") {
            std::tie(made.flag_at, made.flag_size) = offset_and_size(reference(field(member, "discriminator")));
            for (const int v : references(module_.metadata(reference(field(member, "elements"))))) {
                const std::string_view variant = module_.metadata(v);
                if (field(variant, "name") != "Some") continue;
                const SourceType some = type(reference(field(variant, "baseType")));
                made.kind = Kind::optional;
                made.parts = some.parts;
            }
            return;
        }
        if ((kind != "DW_TAG_member" && kind != "DW_TAG_inheritance") ||
            member.find("DIFlagStaticMember") != std::string_view::npos)
            continue;
        SourceType part = type(reference(field(member, "baseType")));
        part.member = field(member, "name");
        part.at = number_in(field(member, "offset")) / 8;
        made.parts.push_back(std::move(part));
    }
    for (const SourceType& p : made.parts)  // the flag of std::optional, which may stand in a base
        if (p.flag_size > 0) made.flag_at = p.at + p.flag_at, made.flag_size = p.flag_size;
        else if (p.member == "_M_engaged" || p.member == "__engaged_") made.flag_at = p.at, made.flag_size = 1;
    if (is_optional && language_ == SourceLanguage::cpp) {
        made.kind = Kind::optional;
        SourceType value;
        for (const int p : references(module_.metadata(reference(field(text, "templateParams")))))
            value = type(reference(field(module_.metadata(p), "type")));
        made.parts = {value};
    }
}

/// Arguments and result of a function without debug information.
void take_ir_types(UserSignature& s, Module& module, const IrFunction& f, const std::string& path) {
    const auto number = [](std::size_t size) {
        return SourceType{.kind = Kind::number, .name = size == 4 ? "float" : "double", .size = size};
    };
    const auto type_of_text = [&module](std::string_view text) {
        Cursor at(text);
        return module.type(at);
    };
    // An opaque pointer leads to numbers of the size that the function computes with.
    std::size_t usual = 8;
    for (const Block& b : f.blocks)
        for (const std::string_view line : b.lines)
            if (line.find(" float ") != std::string_view::npos) usual = 4;
    const std::function<SourceType(const Type&)> source_type = [&](const Type& t) {
        SourceType made{.name = {}, .size = t.size};
        if (t.kind == Type::Kind::number) return number(t.size);
        if (t.kind == Type::Kind::integer) made.kind = Kind::whole;
        if (t.kind == Type::Kind::nothing) made.kind = Kind::nothing;
        if (t.kind == Type::Kind::sequence)
            made.kind = Kind::sequence, made.parts = {source_type(*t.parts[0])}, made.count = t.count;
        if (t.kind == Type::Kind::structure) {
            made.kind = Kind::structure;
            for (std::size_t k = 0; k < t.parts.size(); ++k) {
                made.parts.push_back(source_type(*t.parts[k]));
                made.parts.back().member = std::to_string(k), made.parts.back().at = t.at[k];
            }
        }
        return made;
    };
    for (const IrParameter& p : f.parameters) {
        const bool is_plain = p.name.find_first_not_of("0123456789") != std::string::npos;
        Argument a{.name = is_plain ? p.name : "p" + std::to_string(s.arguments.size()), .type = source_type(*p.type)};
        if (p.type->kind == Type::Kind::pointer) {
            const bool typed = p.type_text.ends_with('*');
            const bool is_answer = is_one_of(small(a.name), {"t", "tout", "thit", "dist", "far", "hit", "u", "v"});
            a.type = {.kind = Kind::pointer, .name = "*", .size = 8, .is_const = !is_answer};
            const std::string_view target = p.type_text.substr(0, p.type_text.size() - (typed ? 1 : 0));
            a.type.parts = {typed ? source_type(*type_of_text(target)) : number(usual)};
        }
        if (a.type.kind == Kind::sequence || a.type.kind == Kind::other ||
            p.text.find("sret") != std::string_view::npos)
            throw InputError(path + ": the function " + s.call +
                             " takes parts of structures, whose meaning only debug "
                             "information says; compile it with -g");
        s.arguments.push_back(std::move(a));
    }
    s.returned = source_type(*type_of_text(f.returned_text));
}

}  // namespace

bool mentions(const std::string& source, const std::string& name) {
    const std::string plain = name.substr(0, name.find('<'));
    const std::string last = plain.substr(plain.rfind(':') == std::string::npos ? 0 : plain.rfind(':') + 1);
    const auto is_of_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    for (std::size_t at = source.find(last); at != std::string::npos; at = source.find(last, at + 1)) {
        const std::size_t end = at + last.size();
        if ((at == 0 || !is_of_word(source[at - 1])) && (end == source.size() || !is_of_word(source[end]))) return true;
    }
    return false;
}

std::string text_of_part(const Argument& argument, std::size_t at) {
    const bool is_pointer = argument.type.kind == Kind::pointer && argument.type.name == "*";
    std::string text = argument.name;
    const SourceType* type = &argument.target();
    if (is_pointer && type->kind == Kind::number && type->size > 0)
        return text + "[" + std::to_string(at / type->size) + "]";
    for (bool first = true; type != nullptr; first = false) {
        const SourceType* next = nullptr;
        if (type->kind == Kind::sequence && type->parts[0].size > 0) {
            next = type->parts.data();
            text += "[" + std::to_string(at / next->size) + "]";
            at %= next->size;
        } else if (type->kind == Kind::structure) {
            for (const SourceType& p : type->parts)
                if (at >= p.at && at < p.at + p.size) next = &p;
            if (next == nullptr) break;
            if (!next->member.empty()) text += (is_pointer && first ? "->" : ".") + next->member;
            at -= next->at;
        }
        type = next;
    }
    return text;
}

std::string no_function(const std::string& ir, const std::string& path, const std::string& name,
                        SourceLanguage language) {
    constexpr std::size_t most_listed = 12;
    std::set<std::string> names;
    if (ir.find("define ") != std::string::npos) {
        const Module module(ir);
        for (const auto& [symbol, f] : module.functions) {
            const std::string_view text = module.metadata(f.subprogram);
            const std::filesystem::path file = field(module.metadata(reference(field(text, "file"))), "filename");
            if (language != SourceLanguage::llvm && file.filename() != std::filesystem::path(path).filename()) continue;
            names.insert(text.empty() ? symbol : qualified(module, text, language));
        }
    }
    std::string all = names.empty() ? "; it defines none" : "";
    std::size_t listed = 0;
    for (const std::string& each : names) {
        if (listed++ < most_listed) all += (all.empty() ? "; it defines " : ", ") + external::shown_text(each);
    }
    if (listed > most_listed) all += " and " + std::to_string(listed - most_listed) + " more";
    return path + ": has no function " + external::shown_text(name) + all;
}

UserSignature signature_of(Module& module, const std::string& path, const std::string& name, SourceLanguage language) {
    // The definition whose debug information has the name; of several, the one with the whole name.
    const IrFunction* found = nullptr;
    const std::size_t mark = name.find('@');
    const std::string own = name.substr(0, mark), chosen = mark == std::string::npos ? "" : name.substr(mark + 1);
    const std::string last = own.substr(own.rfind(':') == std::string::npos ? 0 : own.rfind(':') + 1);
    std::string_view text;
    std::string lines;
    bool is_overloaded = false;
    for (const auto& [symbol, f] : module.functions) {
        const std::string_view subprogram = module.metadata(f.subprogram);
        const std::string called = field(subprogram, "name");
        if (called != last && symbol != own && !called.starts_with(last + "<")) continue;
        const std::string line = field(subprogram, "line");
        if (!chosen.empty() && line != chosen) continue;
        // Functions of shaders have no names but these; those of C++ also have a name for the linker.
        is_overloaded = is_overloaded || (found != nullptr && language == SourceLanguage::llvm &&
                                          field(subprogram, "linkageName").empty() && field(text, "line") != line);
        lines += (lines.empty() ? "" : ", ") + own + "@" + line;
        if (found != nullptr && field(text, "linkageName").find(own) != std::string::npos) continue;
        found = &f;
        text = subprogram;
    }
    if (found == nullptr) throw InputError(no_function(module.text(), path, name, language));
    if (is_overloaded)
        throw InputError(path + ": has several functions " + external::shown_text(own) +
                         "; name one by its line: " + lines);
    UserSignature s;
    s.language = language;
    s.call = own;
    s.symbol = found->name;
    s.line = static_cast<int>(number_in(field(text, "line")));
    if (language == SourceLanguage::llvm) {
        if (found->subprogram < 0) {
            take_ir_types(s, module, *found, path);
            return s;
        }
        const std::string_view unit = module.metadata(reference(field(text, "unit")));
        language = unit.find("DW_LANG_Rust") != std::string_view::npos          ? SourceLanguage::rust
                   : unit.find("DW_LANG_C_plus_plus") != std::string_view::npos ? SourceLanguage::cpp
                                                                                : SourceLanguage::c;
        const std::string_view file = module.metadata(reference(field(text, "file")));
        s.folder = (std::filesystem::path(field(file, "directory")) / field(file, "filename")).parent_path().string();
    }
    const std::vector<int> types =
        references(module.metadata(reference(field(module.metadata(reference(field(text, "type"))), "types"))));
    if (types.empty())
        throw InputError(path + ": the function " + name + " has no debug information; compile it with -g");
    s.returned = TypeReader(module, language).type(types[0]);
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
                   .type = TypeReader(module, language).type(types[k])};
        a.is_this = k == 1 && has_this;
        s.arguments.push_back(std::move(a));
    }
    return s;
}

Stated stated_by(const std::string& text, const std::string& where) {
    Stated s;
    s.where = where;
    std::string_view rest = text;
    const auto trimmed = [](std::string_view t) {
        while (!t.empty() && std::isspace(static_cast<unsigned char>(t.front())) != 0) t.remove_prefix(1);
        while (!t.empty() && std::isspace(static_cast<unsigned char>(t.back())) != 0) t.remove_suffix(1);
        return std::string(t);
    };
    if (const std::size_t end = rest.find("*/"); end != std::string_view::npos) rest = rest.substr(0, end);
    rest = rest.substr(std::min(rest.find_first_not_of(" \t"), rest.size()));
    const std::size_t name_end = std::min(rest.find_first_of("(,= \t-"), rest.size());
    if (const std::size_t after = std::min(rest.find_first_not_of(" \t", name_end), rest.size());
        after >= rest.size() || rest[after] != '=') {
        s.shape = small(rest.substr(0, name_end));
        rest = rest.substr(after);
        if (rest.starts_with('(')) {
            const std::size_t close = std::min(rest.find(')'), rest.size());
            std::string_view list = rest.substr(1, close - 1);
            s.has_roles = true;
            while (!trimmed(list).empty()) {
                const std::size_t comma = std::min(list.find(','), list.size());
                s.roles.push_back(trimmed(list.substr(0, comma)));
                list = list.substr(std::min(comma + 1, list.size()));
            }
            rest = rest.substr(std::min(close + 1, rest.size()));
        }
    }
    // A word ends at a comma, or at a blank before the next `key=`, as in comments for --shader.
    const auto end_of_word = [](std::string_view t) {
        bool quoted = false;
        for (std::size_t k = 0; k < t.size(); ++k) {
            if (t[k] == '"') quoted = !quoted;
            const std::size_t next = t.find_first_not_of(" \t", k), end = t.find_first_of(" \t,=", next);
            const bool key =
                next != std::string_view::npos && next > k && end < t.size() && t[end] == '=' && end > next;
            if (!quoted && (t[k] == ',' || (key && k > 0 && t[k - 1] != '='))) return k;
        }
        return t.size();
    };
    while (!trimmed(rest).empty()) {
        const std::size_t comma = end_of_word(rest);
        std::string word = trimmed(rest.substr(0, comma));
        std::erase(word, '"');
        rest = rest.substr(std::min(comma + 1, rest.size()));
        const std::size_t equals = word.find('=');
        if (equals != std::string::npos)
            s.words.emplace_back(trimmed(std::string_view(word).substr(0, equals)),
                                 trimmed(std::string_view(word).substr(equals + 1)));
        else if (!word.empty() && !word.starts_with("->"))
            throw InputError(where + ": " + external::shown_text(word) +
                             " is not understood; write, for example, sphere(o, d, c, r), miss = -1, roots = near");
    }
    return s;
}

Stated stated_in(const std::string& source, const std::string& path, int definition) {
    std::optional<Stated> own, other;
    constexpr std::string_view mark = "lostbits:";
    std::vector<std::string> lines;
    std::istringstream in(source);
    for (std::string text; std::getline(in, text);) lines.push_back(text);
    for (std::size_t k = 0; k < lines.size(); ++k) {
        const std::size_t at = lines[k].find(mark);
        if (at == std::string::npos || std::min(lines[k].find("//"), lines[k].find("/*")) > at) continue;
        const auto stated = [&] {
            return stated_by(lines[k].substr(at + mark.size()),
                             path + ":" + std::to_string(k + 1) + ":" + std::to_string(at + 1));
        };
        std::size_t below = k + 1;  // the first line of code
        while (below < lines.size() && lines[below].find_first_not_of(" \t") != std::string::npos &&
               std::string_view("/*#").find(lines[below][lines[below].find_first_not_of(" \t")]) !=
                   std::string_view::npos)
            ++below;
        const auto line = static_cast<std::size_t>(std::max(definition - 1, 0));
        const auto ends = [](const std::string& text) { return text.find_first_of("{;") != std::string::npos; };
        const bool is_above = below <= line && line < lines.size() &&
                              std::none_of(lines.begin() + static_cast<std::ptrdiff_t>(below),
                                           lines.begin() + static_cast<std::ptrdiff_t>(line), ends);
        const bool is_inside = k >= line && definition > 0 && k < lines.size() &&
                               std::none_of(lines.begin() + static_cast<std::ptrdiff_t>(line),
                                            lines.begin() + static_cast<std::ptrdiff_t>(k),
                                            [](const std::string& text) { return text.starts_with('}'); });
        const bool is_function = below < lines.size() && lines[below].find('(') != std::string::npos;
        std::optional<Stated>& which = is_inside || (is_above && is_function) ? own : other;
        if (&which == &other && is_function) continue;
        Stated more = stated();
        if (which && more.shape.empty()) which->words.insert(which->words.end(), more.words.begin(), more.words.end());
        else which = std::move(more);
    }
    return own ? *own : other.value_or(Stated());
}

}  // namespace lostbits::intersect::function
