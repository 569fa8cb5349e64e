// Places and names of operations, from the debug information.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Places and names

int Walk::place_at(int location, int caller, int depth) {
    if (depth > 1000) return -1;
    const auto [known, is_new] = known_places_.try_emplace({location, caller}, -1);
    if (!is_new) return known->second;
    const std::string_view text = module_.metadata(location);
    const std::string line = field(text, "line");
    if (text.find("DILocation") == std::string_view::npos || line.empty()) return -1;
    SourcePlace place;
    const auto number = [](const std::string& digits) {
        int n = 0;
        std::from_chars(digits.data(), digits.data() + digits.size(), n);
        return n;
    };
    place.line = number(line), place.column = number(field(text, "column"));
    place.caller = caller;
    if (const int inlined = reference(field(text, "inlinedAt")); inlined >= 0 && inlined != location)
        place.caller = place_at(inlined, caller, depth + 1);
    const int scope = reference(field(text, "scope"));
    const std::string_view file = module_.metadata(reference(field(module_.metadata(scope), "file")));
    place.file = field(file, "filename");
    const std::string folder = field(file, "directory");
    if (!place.file.starts_with('/') && !folder.empty()) place.file = folder + "/" + place.file;
    places_.push_back(std::move(place));
    const int index = static_cast<int>(places_.size() - 1);
    known_places_[{location, caller}] = index;
    return index;
}

int Walk::index_of(std::string_view line, const Frame& frame) {
    constexpr std::string_view dbg_marker = "!dbg !";
    const std::size_t marker_at = line.rfind(dbg_marker);
    if (marker_at != std::string_view::npos) return place_at(reference(line.substr(marker_at + 5)), frame.caller);
    const bool is_user = frame.function->subprogram < 0 && depth_ > 1;  // the outermost function is the wrapper
    return ir_file_.empty() || !is_user ? -1 : ir_place(line, frame.caller);
}

/// Index of the place in the user's LLVM IR of the operation after `%name =`.
int Walk::ir_place(std::string_view line, int caller) {
    const int line_number = module_.line_of(line);
    const auto [known, is_new] = known_places_.try_emplace({-line_number, caller}, static_cast<int>(places_.size()));
    if (is_new) {
        const std::size_t equals = line.find(" = "), first = line.find_first_not_of(" \t");
        const std::size_t column = (equals == std::string_view::npos ? std::min(first, line.size()) : equals + 3) + 1;
        places_.push_back({ir_file_, line_number, static_cast<int>(column), caller});
    }
    return known->second;
}

int Walk::own_place(int place) const {
    for (int guard = 0; place >= 0 && guard < 100; ++guard) {
        const SourcePlace& p = places_[static_cast<std::size_t>(place)];
        if (p.line > 0 && (p.file.starts_with(own_folder_) || p.file == ir_file_)) return place;
        place = p.caller;
    }
    return -1;
}

/// Name of the part of a variable at an offset, by the types of the debug information: `.x`, `[1]`.
std::string Walk::path_in(int variable, std::size_t offset) const {
    const auto number = [](const std::string& s) {
        std::size_t n = 0;
        std::from_chars(s.data(), s.data() + s.size(), n);
        return n;
    };
    std::string path;
    int type = reference(field(module_.metadata(variable), "type"));
    for (int guard = 0; guard < 20 && type >= 0; ++guard) {
        const std::string_view t = module_.metadata(type);
        if (t.find("DIDerivedType") != std::string_view::npos) {
            type = reference(field(t, "baseType"));
        } else if (t.find("DW_TAG_array_type") != std::string_view::npos) {
            type = reference(field(t, "baseType"));
            const std::size_t size = number(field(module_.metadata(type), "size")) / 8;
            if (size == 0) break;
            path += "[" + std::to_string(offset / size) + "]";
            offset %= size;
        } else if (t.find("DICompositeType") != std::string_view::npos) {
            int member_type = -1;
            for (const int m : references(module_.metadata(reference(field(t, "elements"))))) {
                const std::string_view member = module_.metadata(m);
                const std::string tag = field(member, "tag");
                if (tag != "DW_TAG_member" && tag != "DW_TAG_inheritance") continue;
                const std::size_t begin = number(field(member, "offset")) / 8;
                const std::size_t size = number(field(member, "size")) / 8;
                if (offset < begin || offset >= begin + size) continue;
                if (const std::string n = field(member, "name"); !n.empty()) path += "." + n;
                member_type = reference(field(member, "baseType"));
                offset -= begin;
                break;
            }
            if (member_type < 0) break;
            type = member_type;
        } else {
            break;
        }
    }
    return path;
}

/// Names the numbers of a value after the variable that stores the value at offset `first_byte`.
void Walk::name_value(int variable, const Value& value, std::size_t first_byte, int depth) {
    const std::string_view text = module_.metadata(variable);
    const std::string name = field(text, "name");
    if (name.empty() || name.starts_with("lb_")) return;  // a variable of the wrapper
    const bool is_argument = !field(text, "arg").empty() || field(text, "flags") == "DIFlagArtificial";
    if (is_argument && depth > 2) return;
    std::string prefix;
    if (depth > 2) {
        int scope = reference(field(text, "scope"));
        for (int guard = 0; guard < 20 && scope >= 0; ++guard) {
            const std::string_view enclosing_scope = module_.metadata(scope);
            if (enclosing_scope.find("DISubprogram") != std::string_view::npos) {
                prefix = field(enclosing_scope, "name") + ".";
                break;
            }
            scope = reference(field(enclosing_scope, "scope"));
        }
    }
    for (const auto& [offset, cell] : value) {
        if (cell.scalar.kind != Scalar::Kind::number) continue;
        const std::string full_name = prefix + name + path_in(variable, first_byte + offset);
        if (!is_argument) nodes_.name(cell.scalar.node, full_name, depth);
        if (depth <= 2)
            stored_.push_back({full_name, cell.scalar.node, nodes_.place, std::atoi(field(text, "line").c_str())});
    }
}

/// Handles `llvm.dbg.declare`, `llvm.dbg.value`, and the records that replace them since LLVM 19.
void Walk::declare(State& state, std::string_view line, Cursor cursor, bool is_record) {
    const bool is_memory =
        line.find("dbg_declare") != std::string_view::npos || line.find("@llvm.dbg.declare") != std::string_view::npos;
    const bool is_value =
        line.find("dbg_value") != std::string_view::npos || line.find("@llvm.dbg.value") != std::string_view::npos;
    if (!is_memory && !is_value) return;
    while (!cursor.at_end() && cursor.peek() != '(') cursor = Cursor(cursor.rest().substr(1));
    Cursor inside(cursor.group());
    inside.take("metadata");
    if (inside.peek() == '!' || inside.take("poison") || inside.take("undef")) return;
    const Type* const type = module_.type(inside);
    if (!inside.take("%")) return;
    const std::string name = inside.name();
    const auto found = state.registers.find(name);
    if (found == state.registers.end()) return;
    const std::size_t reference_at = inside.rest().find('!');
    if (reference_at == std::string_view::npos) return;
    const int variable = reference(inside.rest().substr(reference_at));
    int depth = depth_;
    if (is_record) {
        int location = reference(line.substr(std::min(line.rfind('!'), line.size())));
        for (int guard = 0; location >= 0 && guard < 50; ++guard) {
            location = reference(field(module_.metadata(location), "inlinedAt"));
            if (location >= 0) ++depth;
        }
    }
    if (is_memory) {
        if (line.find("DIExpression()") == std::string_view::npos) return;
        for (const Case& c : cases_of(found->second, *type)) variables_[c.object] = {variable, depth};
        return;
    }
    std::size_t first_byte = 0;
    if (line.find("DIExpression()") == std::string_view::npos) {
        constexpr std::string_view fragment = "DIExpression(DW_OP_LLVM_fragment, ";
        const std::size_t begin = line.find(fragment);
        if (begin == std::string_view::npos) return;
        const std::string_view digits = line.substr(begin + fragment.size());
        std::from_chars(digits.data(), digits.data() + digits.size(), first_byte);
        first_byte /= 8;
    }
    name_value(variable, found->second, first_byte, depth);
}

}  // namespace lostbits::intersect::function
