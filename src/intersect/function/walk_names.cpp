// Debug information: its fields, and the places and names of operations.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Fields

std::string metadata_field(std::string_view metadata, std::string_view name) {
    const std::string key = std::string(name) + ": ";
    for (std::size_t position = metadata.find(key); position != std::string_view::npos;
         position = metadata.find(key, position + 1)) {
        if (position == 0 || (metadata[position - 1] != ' ' && metadata[position - 1] != '(')) continue;
        std::string_view value = metadata.substr(position + key.size());
        if (value.starts_with('"')) {
            const std::size_t end = value.find('"', 1);
            return std::string(value.substr(1, end == std::string_view::npos ? end : end - 1));
        }
        return std::string(value.substr(0, value.find_first_of(",)")));
    }
    return {};
}

int metadata_index(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    if (!text.starts_with('!')) return -1;
    int n = -1;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), n);
    return error == std::errc() ? n : -1;
}

std::vector<int> metadata_indices(std::string_view metadata) {
    std::vector<int> indices;
    const std::size_t open = metadata.find('{');
    if (open == std::string_view::npos) return indices;
    std::string_view rest = metadata.substr(open + 1);
    while (!rest.empty() && rest.front() != '}') {
        indices.push_back(metadata_index(rest));
        const std::size_t comma = rest.find(',');
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (indices.size() == 1 && indices[0] == -1 && metadata.find("null") == std::string_view::npos) indices.clear();
    return indices;
}

namespace {

template <class Integer>
Integer parse_number(const std::string& digits) {
    Integer n = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), n);
    return n;
}

/// Reads the path of the file to which a scope of the debug information belongs.
std::string read_scope_file(const Module& module, int scope) {
    const std::string_view file = module.metadata(metadata_index(metadata_field(module.metadata(scope), "file")));
    const std::string name = metadata_field(file, "filename"), folder = metadata_field(file, "directory");
    return name.starts_with('/') || folder.empty() ? name : folder + "/" + name;
}

/// Finds the name of the function around a variable of the debug information, and appends a dot. Empty without one.
std::string find_function_prefix(const Module& module, std::string_view variable) {
    int scope = metadata_index(metadata_field(variable, "scope"));
    for (int guard = 0; guard < 20 && scope >= 0; ++guard) {
        const std::string_view enclosing_scope = module.metadata(scope);
        if (enclosing_scope.find("DISubprogram") != std::string_view::npos)
            return metadata_field(enclosing_scope, "name") + ".";
        scope = metadata_index(metadata_field(enclosing_scope, "scope"));
    }
    return "";
}

/// Counts the calls that the compiler has inlined between a location and the function that holds it.
int count_inlined_calls(const Module& module, int location) {
    int count = 0;
    for (int guard = 0; location >= 0 && guard < 50; ++guard) {
        location = metadata_index(metadata_field(module.metadata(location), "inlinedAt"));
        if (location >= 0) ++count;
    }
    return count;
}

/// Reads the offset in bytes at which a debug record sets a variable. Nothing if the record computes its value.
std::optional<std::size_t> read_fragment_offset(std::string_view line) {
    if (line.find("DIExpression()") != std::string_view::npos) return 0;
    constexpr std::string_view fragment = "DIExpression(DW_OP_LLVM_fragment, ";
    const std::size_t begin = line.find(fragment);
    if (begin == std::string_view::npos) return {};
    const std::string_view digits = line.substr(begin + fragment.size());
    std::size_t bits = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), bits);
    return bits / 8;
}

/// A member of a class or structure: the names that lead to it, its type and its offset in bytes.
struct MemberAtOffset {
    std::string path;
    int type = -1;
    std::size_t offset = 0;
};

/// Finds the member that contains the byte at `offset`. Its type is -1 if no member contains it.
MemberAtOffset find_member(const Module& module, std::string_view composite, std::size_t offset) {
    for (const int m : metadata_indices(module.metadata(metadata_index(metadata_field(composite, "elements"))))) {
        const std::string_view member = module.metadata(m);
        const std::string tag = metadata_field(member, "tag");
        if (tag != "DW_TAG_member" && tag != "DW_TAG_inheritance") continue;

        const std::size_t begin = parse_number<std::size_t>(metadata_field(member, "offset")) / 8;
        const std::size_t size = parse_number<std::size_t>(metadata_field(member, "size")) / 8;
        if (offset < begin || offset >= begin + size) continue;
        const std::string name = metadata_field(member, "name");
        return {name.empty() ? "" : "." + name, metadata_index(metadata_field(member, "baseType")), begin};
    }
    return {};
}

}  // namespace

// Places and names

int Walk::place_of_location(int location, int caller, int depth) {
    if (depth > 1000) return -1;
    const auto [known_place, is_new] = known_places_.try_emplace({location, caller}, -1);
    if (!is_new) return known_place->second;
    const std::string_view text = module_.metadata(location);
    const std::string line = metadata_field(text, "line");
    if (text.find("DILocation") == std::string_view::npos || line.empty()) return -1;

    SourcePlace place;
    place.line = parse_number<int>(line);
    place.column = parse_number<int>(metadata_field(text, "column"));
    place.caller = caller;
    if (const int inlined = metadata_index(metadata_field(text, "inlinedAt")); inlined >= 0 && inlined != location)
        place.caller = place_of_location(inlined, caller, depth + 1);
    place.file = read_scope_file(module_, metadata_index(metadata_field(text, "scope")));

    places_.push_back(std::move(place));
    const int index = static_cast<int>(places_.size() - 1);
    known_places_[{location, caller}] = index;
    return index;
}

int Walk::place_of_line(std::string_view line, const CallFrame& frame) {
    constexpr std::string_view dbg_marker = "!dbg !";
    const std::size_t marker_at = line.rfind(dbg_marker);
    if (marker_at != std::string_view::npos)
        return place_of_location(metadata_index(line.substr(marker_at + 5)), frame.caller);
    const bool is_users_function = frame.function->subprogram < 0 && depth_ > 1;  // the outermost one is the wrapper
    return ir_file_.empty() || !is_users_function ? -1 : place_in_ir(line, frame.caller);
}

/// Index of the place of an instruction in the user's LLVM IR; its column is where the operation begins, after
/// `%name =`.
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
        const SourcePlace& p = places_[place];
        if (p.line > 0 && (p.file.starts_with(user_folder_) || p.file == ir_file_)) return place;
        place = p.caller;
    }
    return -1;
}

/// Name of the part at an offset of a variable, from the types in the debug information: `.x`, `[1]`.
std::string Walk::member_path(int variable, std::size_t offset) const {
    std::string path;
    int type = metadata_index(metadata_field(module_.metadata(variable), "type"));
    for (int guard = 0; guard < 20 && type >= 0; ++guard) {
        const std::string_view t = module_.metadata(type);
        if (t.find("DIDerivedType") != std::string_view::npos) {
            type = metadata_index(metadata_field(t, "baseType"));
        } else if (t.find("DW_TAG_array_type") != std::string_view::npos) {
            type = metadata_index(metadata_field(t, "baseType"));
            const std::size_t size = parse_number<std::size_t>(metadata_field(module_.metadata(type), "size")) / 8;
            if (size == 0) break;
            path += "[" + std::to_string(offset / size) + "]";
            offset %= size;
        } else if (t.find("DICompositeType") != std::string_view::npos) {
            const MemberAtOffset member = find_member(module_, t, offset);
            path += member.path;
            offset -= member.offset;
            type = member.type;
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

    // Functions that the user's function calls: their variables have the name of the function in front.
    const bool is_inner = depth > 2;
    if (is_argument && is_inner) return;
    const std::string prefix = is_inner ? find_function_prefix(module_, text) : "";

    for (const auto& [offset, cell] : value) {
        if (cell.scalar.kind != Scalar::Kind::number) continue;
        const std::string full_name = prefix + name + member_path(variable, first_byte + offset);
        if (!is_argument) nodes_.name_node(cell.scalar.node, full_name, depth);
        if (!is_inner)
            stored_.push_back(
                {full_name, cell.scalar.node, nodes_.place, std::atoi(metadata_field(text, "line").c_str())});
    }
}

/// Handles `llvm.dbg.declare`, `llvm.dbg.value`, and the records that replace them since LLVM 19.
void Walk::handle_debug_record(MemoryState& state, std::string_view line, Cursor cursor, bool is_record) {
    const bool is_memory =
        line.find("dbg_declare") != std::string_view::npos || line.find("@llvm.dbg.declare") != std::string_view::npos;
    const bool is_value =
        line.find("dbg_value") != std::string_view::npos || line.find("@llvm.dbg.value") != std::string_view::npos;
    if (!is_memory && !is_value) return;

    // Reads `(TYPE %REGISTER, !VARIABLE, ...)`.
    while (!cursor.at_end() && cursor.peek() != '(') cursor = Cursor(cursor.rest().substr(1));
    Cursor inside(cursor.take_group());
    inside.take("metadata");
    if (inside.peek() == '!' || inside.take("poison") || inside.take("undef")) return;
    const Type* const type = module_.read_type(inside);
    if (!inside.take("%")) return;
    const auto stored_register = state.registers.find(inside.take_name());
    if (stored_register == state.registers.end()) return;
    const std::size_t reference_at = inside.rest().find('!');
    if (reference_at == std::string_view::npos) return;
    const int variable = metadata_index(inside.rest().substr(reference_at));

    // A record ends with its location. The variable of an inlined function is as deep as if the function were called.
    int depth = depth_;
    if (is_record)
        depth += count_inlined_calls(module_, metadata_index(line.substr(std::min(line.rfind('!'), line.size()))));

    if (is_memory) {
        if (line.find("DIExpression()") == std::string_view::npos) return;
        for (const PossibleValue& c : cases_of(stored_register->second, *type))
            variables_[c.memory_object] = {variable, depth};
    } else if (const auto first_byte = read_fragment_offset(line)) {
        name_value(variable, stored_register->second, *first_byte, depth);
    }
}

}  // namespace lostbits::intersect::function
