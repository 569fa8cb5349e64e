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

int Walk::place_of_location(int location, int caller, int depth) {
    if (depth > 1000) return -1;
    const auto [known_place, is_new] = known_places_.try_emplace({location, caller}, -1);
    if (!is_new) return known_place->second;
    const std::string_view text = module_.metadata(location);
    const std::string line = metadata_field(text, "line");
    if (text.find("DILocation") == std::string_view::npos || line.empty()) return -1;
    SourcePlace place;
    const auto number = [](const std::string& digits) {
        int n = 0;
        std::from_chars(digits.data(), digits.data() + digits.size(), n);
        return n;
    };
    place.line = number(line), place.column = number(metadata_field(text, "column"));
    place.caller = caller;
    if (const int inlined = metadata_index(metadata_field(text, "inlinedAt")); inlined >= 0 && inlined != location)
        place.caller = place_of_location(inlined, caller, depth + 1);
    const int scope = metadata_index(metadata_field(text, "scope"));
    const std::string_view file = module_.metadata(metadata_index(metadata_field(module_.metadata(scope), "file")));
    place.file = metadata_field(file, "filename");
    const std::string folder = metadata_field(file, "directory");
    if (!place.file.starts_with('/') && !folder.empty()) place.file = folder + "/" + place.file;
    places_.push_back(std::move(place));
    const int index = static_cast<int>(places_.size() - 1);
    known_places_[{location, caller}] = index;
    return index;
}

int Walk::place_of_line(std::string_view line, const Frame& frame) {
    constexpr std::string_view dbg_marker = "!dbg !";
    const std::size_t marker_at = line.rfind(dbg_marker);
    if (marker_at != std::string_view::npos)
        return place_of_location(metadata_index(line.substr(marker_at + 5)), frame.caller);
    const bool is_users_function = frame.function->subprogram < 0 && depth_ > 1;  // the outermost one is the wrapper
    return ir_file_.empty() || !is_users_function ? -1 : place_in_ir(line, frame.caller);
}

/// Index of the place of an instruction in the user's LLVM IR; its column is that of the operation after `%name =`.
int Walk::place_in_ir(std::string_view line, int caller) {
    const int line_number = module_.line_of(line);
    const auto [known, is_new] = known_places_.try_emplace({-line_number, caller}, static_cast<int>(places_.size()));
    if (is_new) {
        const std::size_t equals = line.find(" = "), first = line.find_first_not_of(" \t");
        const std::size_t column = (equals == std::string_view::npos ? std::min(first, line.size()) : equals + 3) + 1;
        places_.push_back({ir_file_, line_number, static_cast<int>(column), caller});
    }
    return known->second;
}

int Walk::innermost_user_place(int place) const {
    for (int guard = 0; place >= 0 && guard < 100; ++guard) {
        const SourcePlace& p = places_[static_cast<std::size_t>(place)];
        if (p.line > 0 && (p.file.starts_with(user_folder_) || p.file == ir_file_)) return place;
        place = p.caller;
    }
    return -1;
}

/// Name of the part at an offset of a variable, from the types in the debug information: `.x`, `[1]`.
std::string Walk::member_path(int variable, std::size_t offset) const {
    const auto number = [](const std::string& s) {
        std::size_t n = 0;
        std::from_chars(s.data(), s.data() + s.size(), n);
        return n;
    };
    std::string path;
    int type = metadata_index(metadata_field(module_.metadata(variable), "type"));
    for (int guard = 0; guard < 20 && type >= 0; ++guard) {
        const std::string_view t = module_.metadata(type);
        if (t.find("DIDerivedType") != std::string_view::npos) {
            type = metadata_index(metadata_field(t, "baseType"));
        } else if (t.find("DW_TAG_array_type") != std::string_view::npos) {
            type = metadata_index(metadata_field(t, "baseType"));
            const std::size_t size = number(metadata_field(module_.metadata(type), "size")) / 8;
            if (size == 0) break;
            path += "[" + std::to_string(offset / size) + "]";
            offset %= size;
        } else if (t.find("DICompositeType") != std::string_view::npos) {
            int member_type = -1;
            for (const int m : metadata_indices(module_.metadata(metadata_index(metadata_field(t, "elements"))))) {
                const std::string_view member = module_.metadata(m);
                const std::string tag = metadata_field(member, "tag");
                if (tag != "DW_TAG_member" && tag != "DW_TAG_inheritance") continue;
                const std::size_t begin = number(metadata_field(member, "offset")) / 8;
                const std::size_t size = number(metadata_field(member, "size")) / 8;
                if (offset < begin || offset >= begin + size) continue;
                if (const std::string n = metadata_field(member, "name"); !n.empty()) path += "." + n;
                member_type = metadata_index(metadata_field(member, "baseType"));
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
    const std::string name = metadata_field(text, "name");
    if (name.empty() || name.starts_with("lb_")) return;  // a variable of the wrapper
    const bool is_argument =
        !metadata_field(text, "arg").empty() || metadata_field(text, "flags") == "DIFlagArtificial";
    if (is_argument && depth > 2) return;
    std::string prefix;
    if (depth > 2) {
        int scope = metadata_index(metadata_field(text, "scope"));
        for (int guard = 0; guard < 20 && scope >= 0; ++guard) {
            const std::string_view enclosing_scope = module_.metadata(scope);
            if (enclosing_scope.find("DISubprogram") != std::string_view::npos) {
                prefix = metadata_field(enclosing_scope, "name") + ".";
                break;
            }
            scope = metadata_index(metadata_field(enclosing_scope, "scope"));
        }
    }
    for (const auto& [offset, cell] : value) {
        if (cell.scalar.kind != Scalar::Kind::number) continue;
        const std::string full_name = prefix + name + member_path(variable, first_byte + offset);
        if (!is_argument) nodes_.name_node(cell.scalar.node, full_name, depth);
        if (depth <= 2)
            stored_.push_back(
                {full_name, cell.scalar.node, nodes_.place, std::atoi(metadata_field(text, "line").c_str())});
    }
}

/// Handles `llvm.dbg.declare`, `llvm.dbg.value`, and the records that replace them since LLVM 19.
void Walk::handle_debug_record(State& state, std::string_view line, Cursor cursor, bool is_record) {
    const bool is_memory =
        line.find("dbg_declare") != std::string_view::npos || line.find("@llvm.dbg.declare") != std::string_view::npos;
    const bool is_value =
        line.find("dbg_value") != std::string_view::npos || line.find("@llvm.dbg.value") != std::string_view::npos;
    if (!is_memory && !is_value) return;
    while (!cursor.at_end() && cursor.peek() != '(') cursor = Cursor(cursor.rest().substr(1));
    Cursor inside(cursor.take_group());
    inside.take("metadata");
    if (inside.peek() == '!' || inside.take("poison") || inside.take("undef")) return;
    const Type* const type = module_.read_type(inside);
    if (!inside.take("%")) return;
    const std::string name = inside.take_name();
    const auto stored_register = state.registers.find(name);
    if (stored_register == state.registers.end()) return;
    const std::size_t reference_at = inside.rest().find('!');
    if (reference_at == std::string_view::npos) return;
    const int variable = metadata_index(inside.rest().substr(reference_at));
    int depth = depth_;
    if (is_record) {
        int location = metadata_index(line.substr(std::min(line.rfind('!'), line.size())));
        for (int guard = 0; location >= 0 && guard < 50; ++guard) {
            location = metadata_index(metadata_field(module_.metadata(location), "inlinedAt"));
            if (location >= 0) ++depth;
        }
    }
    if (is_memory) {
        if (line.find("DIExpression()") == std::string_view::npos) return;
        for (const Case& c : cases_of(stored_register->second, *type)) variables_[c.memory_object] = {variable, depth};
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
    name_value(variable, stored_register->second, first_byte, depth);
}

}  // namespace lostbits::intersect::function
