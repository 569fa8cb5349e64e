// Signatures as users state them: in the option, or in comments of the file after `lostbits:`.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <sstream>

#include "intersect/external/pipe_header.hpp"
#include "intersect/function/common_names.hpp"
#include "intersect/function/signature.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::function {
namespace {

std::string trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
    return std::string(text);
}

/// Reads `sphere(o, d, c, r)` or `sphere`, and returns the rest of the text.
std::string_view read_shape_and_roles(std::string_view text, std::size_t name_end, std::size_t next_text,
                                      StatedSignature& result) {
    result.shape = normalise_name(text.substr(0, name_end));
    std::string_view rest = text.substr(next_text);
    if (!rest.starts_with('(')) return rest;

    const std::size_t close = std::min(rest.find(')'), rest.size());
    std::string_view list = rest.substr(1, close - 1);
    result.has_roles = true;
    while (!trimmed(list).empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        result.roles.push_back(trimmed(list.substr(0, comma)));
        list = list.substr(std::min(comma + 1, list.size()));
    }
    return rest.substr(std::min(close + 1, rest.size()));
}

/// Finds the end of a property: a comma, or a blank before the next `key=`, as in comments for --shader.
std::size_t find_property_end(std::string_view text) {
    bool is_quoted = false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] == '"') is_quoted = !is_quoted;
        const std::size_t next = text.find_first_not_of(" \t", k), end = text.find_first_of(" \t,=", next);
        const bool is_key =
            next != std::string_view::npos && next > k && end < text.size() && text[end] == '=' && end > next;
        if (!is_quoted && (text[k] == ',' || (is_key && k > 0 && text[k - 1] != '='))) return k;
    }
    return text.size();
}

/// Reads the value of the property `miss`, such as `-1` or `inf`.
MissValue read_miss_value(const std::string& text, const std::string& message_prefix) {
    if (text == "inf" || text == "infinite") return {MissValue::Kind::infinite, 0};
    if (text == "nan") return {MissValue::Kind::nan, 0};
    if (text == "negative" || text.starts_with('-')) return {MissValue::Kind::negative, 0};
    if (text == "0" || text == "zero") return {MissValue::Kind::zero, 0};
    if (text == "none") return {MissValue::Kind::none, 0};
    if (text == "crossed") return {MissValue::Kind::crossed, 0};

    MissValue above{MissValue::Kind::above, 0};
    if (std::from_chars(text.data(), text.data() + text.size(), above.bound).ec != std::errc())
        throw InputError(message_prefix + ": miss is " + external::quote_text(text) +
                         "; it must be -1, 0, inf, nan, crossed, none, or the number from which on t means a miss");
    return above;
}

/// The lines of a source file, and the line of the definition of a function.
class CommentedSource {
public:
    CommentedSource(const std::string& source, int definition)
        : has_definition_(definition > 0), definition_(static_cast<std::size_t>(std::max(definition - 1, 0))) {
        std::istringstream source_lines(source);
        for (std::string text; std::getline(source_lines, text);) lines_.push_back(text);
    }
    [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

    /// True if a comment on line k belongs to the function: it stands inside the function, or directly above it.
    [[nodiscard]] bool is_of_function(std::size_t k) const {
        const std::size_t code_line = first_code_line_after(k);
        const bool is_above = code_line <= definition_ && definition_ < lines_.size() &&
                              std::none_of(at(code_line), at(definition_), [](const std::string& text) {
                                  return text.find_first_of("{;") != std::string::npos;  // ends a declaration
                              });
        const bool is_inside =
            k >= definition_ && has_definition_ &&
            std::none_of(at(definition_), at(k), [](const std::string& text) { return text.starts_with('}'); });
        return is_inside || (is_above && is_above_function(k));
    }

    /// True if the code after a comment on line k seems to begin a function.
    [[nodiscard]] bool is_above_function(std::size_t k) const {
        const std::size_t code_line = first_code_line_after(k);
        return code_line < lines_.size() && lines_[code_line].find('(') != std::string::npos;
    }

private:
    [[nodiscard]] std::vector<std::string>::const_iterator at(std::size_t k) const {
        return lines_.begin() + static_cast<std::ptrdiff_t>(k);
    }
    /// Index of the first line after line k that is not a comment or a directive. A blank line counts as code.
    [[nodiscard]] std::size_t first_code_line_after(std::size_t k) const {
        for (++k; k < lines_.size(); ++k) {
            const std::size_t first = lines_[k].find_first_not_of(" \t");
            const bool is_comment =
                first != std::string::npos && std::string_view("/*#").find(lines_[k][first]) != std::string_view::npos;
            if (!is_comment) break;
        }
        return k;
    }

    std::vector<std::string> lines_;
    bool has_definition_;
    std::size_t definition_;  ///< index of the line
};

}  // namespace

StatedSignature stated_signature(const std::string& text, const std::string& message_prefix) {
    StatedSignature result;
    result.message_prefix = message_prefix;
    std::string_view rest = text;
    if (const std::size_t end = rest.find("*/"); end != std::string_view::npos) rest = rest.substr(0, end);
    rest = rest.substr(std::min(rest.find_first_not_of(" \t"), rest.size()));

    // A text that begins with `key =` names no shape.
    const std::size_t name_end = std::min(rest.find_first_of("(,= \t-"), rest.size());
    const std::size_t next_text = std::min(rest.find_first_not_of(" \t", name_end), rest.size());
    if (next_text >= rest.size() || rest[next_text] != '=')
        rest = read_shape_and_roles(rest, name_end, next_text, result);

    while (!trimmed(rest).empty()) {
        const std::size_t end = find_property_end(rest);
        std::string property = trimmed(rest.substr(0, end));
        std::erase(property, '"');
        rest = rest.substr(std::min(end + 1, rest.size()));

        const std::size_t equals = property.find('=');
        if (equals != std::string::npos)
            result.properties.emplace_back(trimmed(std::string_view(property).substr(0, equals)),
                                           trimmed(std::string_view(property).substr(equals + 1)));
        else if (!property.empty() && !property.starts_with("->"))
            throw InputError(message_prefix + ": " + external::quote_text(property) +
                             " is not understood; write, for example, sphere(o, d, c, r), miss = -1, roots = near");
    }
    return result;
}

StatedSignature read_signature_in_comments(const std::string& source, const std::string& path, int definition) {
    const CommentedSource commented(source, definition);
    std::optional<StatedSignature> function_statement, file_statement;
    constexpr std::string_view mark = "lostbits:";
    for (std::size_t k = 0; k < commented.lines().size(); ++k) {
        const std::string& line = commented.lines()[k];
        const std::size_t position = line.find(mark);
        if (position == std::string::npos || std::min(line.find("//"), line.find("/*")) > position) continue;

        // A comment above another function is not for this one.
        const bool is_of_function = commented.is_of_function(k);
        if (!is_of_function && commented.is_above_function(k)) continue;
        std::optional<StatedSignature>& target = is_of_function ? function_statement : file_statement;

        // A comment without a shape adds its properties to the comments before it.
        StatedSignature addition =
            stated_signature(line.substr(position + mark.size()),
                             path + ":" + std::to_string(k + 1) + ":" + std::to_string(position + 1));
        if (target && addition.shape.empty())
            target->properties.insert(target->properties.end(), addition.properties.begin(), addition.properties.end());
        else target = std::move(addition);
    }
    return function_statement ? *function_statement : file_statement.value_or(StatedSignature());
}

Shape stated_shape(const StatedSignature& stated) {
    const auto shape_name = std::ranges::find(shape_names, std::string_view(stated.shape));
    if (shape_name != shape_names.end() && *shape_name != "sdf")
        return static_cast<Shape>(shape_name - shape_names.begin());
    std::string all_names;
    for (const std::string_view name : shape_names)
        if (name != "sdf") all_names += (all_names.empty() ? "" : ", ") + std::string(name);
    throw InputError(stated.message_prefix + ": " + external::quote_text(stated.shape) + " is not one of " + all_names);
}

void apply_stated_property(UserSignature& signature, const std::string& key, const std::string& text,
                           const std::string& message_prefix) {
    if (key == "name" || key == "format" || key == "function") return;  // of comments for --shader
    if (key == "miss") signature.miss_value = read_miss_value(text, message_prefix);
    else if (!external::set_property(signature.contract, key, text, message_prefix))
        throw InputError(
            message_prefix + ": unknown property " + external::quote_text(key) +
            "; known properties are miss, roots, direction, touching, at_origin, inside, facing and flags");
}

namespace {

/// True if a part is a number that the function reads.
bool is_input_number(const ArgumentPart& part) { return !part.is_vector && !part.is_out && !part.slot.is_integer; }

/// True if the parts k, k + 1 and k + 2 exist and are numbers that the function reads.
bool are_input_numbers(const std::vector<ArgumentPart>& parts, std::size_t k) {
    return k + 3 <= parts.size() && is_input_number(parts[k]) && is_input_number(parts[k + 1]) &&
           is_input_number(parts[k + 2]);
}

/// Makes the numbers k, k + 1 and k + 2 one vector, with the name `last_name`.
void join_numbers(std::vector<ArgumentPart>& parts, std::size_t k, const std::string& last_name) {
    const auto first = parts.begin() + static_cast<std::ptrdiff_t>(k);
    first->components = {first[0].slot, first[1].slot, first[2].slot};
    first->path = "(" + first[0].path + ", " + first[1].path + ", " + first[2].path + ")";
    first->last_name = last_name;
    first->is_vector = true;
    parts.erase(first + 1, first + 3);
}

}  // namespace

void join_named_components(std::vector<ArgumentPart>& parts) {
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const std::string& name = parts[k].last_name;
        if (name.size() < 2 || name.back() != 'x' || !are_input_numbers(parts, k)) continue;
        const std::string stem = name.substr(0, name.size() - 1);
        if (parts[k + 1].last_name == stem + "y" && parts[k + 2].last_name == stem + "z") join_numbers(parts, k, stem);
    }
}

namespace {

/// Finds the role that a comment names; empty if the name is unknown. Other common names of a key come last.
std::string find_stated_role(const std::string& name, Shape shape) {
    if (name == "-" || name.empty()) return "-";
    if (is_one_of(name, {"o", "d", "1/d", "tmin", "tmax", "t", "far", "hit"})) return name;
    if (is_one_of(name, {"origin", "direction"})) return name.substr(0, 1);
    const auto keys = row_of(shape).keys;
    for (std::size_t k = 0; k < keys.size(); ++k)
        if (name == keys[k].name || name == keys[k].short_name) return key_role(k);
    for (std::size_t k = 0; k < keys.size(); ++k)
        if (is_common_name_of_key(name, keys[k], k, shape)) return key_role(k);
    return "";
}

/// Removes the component from a role such as `o.y`, and returns its index; −1 if it has none.
int split_component(std::string& role) {
    constexpr std::string_view components = "xyz";
    const std::size_t size = role.size();
    if (size < 3 || role[size - 2] != '.' || components.find(role[size - 1]) == std::string_view::npos) return -1;
    const auto component = static_cast<int>(components.find(role[size - 1]));
    role.resize(size - 2);
    return component;
}

/// Gives part `i` the role with index `i` that a comment states. If the role is a vector and the part is a number, this
/// number and the next two are the vector.
void apply_stated_role(std::vector<ArgumentPart>& parts, std::size_t i, Shape shape, const StatedSignature& stated) {
    const auto fail = [&](const std::string& problem) {
        throw InputError(stated.message_prefix + ": " + external::quote_text(stated.roles[i]) + " " + problem);
    };
    std::string name = normalise_name(stated.roles[i]);
    const int component = split_component(name);
    const std::string role = find_stated_role(name, shape);
    if (role.empty())
        fail("is not one of o, d, 1/d, tmin, tmax, t, far, hit, -, or a part of " + with_article(shape) + ": " +
             key_list(shape));

    const bool is_number = is_answer_role(role) || is_one_of(role, {"tmin", "tmax"}) ||
                           (role[0] == 'k' && row_of(shape).keys[key_index(role)].count() == 1);
    ArgumentPart& part = parts[i];
    if (component >= 0) {
        if (is_number || role == "-" || !is_input_number(part))
            fail("names a component, but " + part.path + " is not one");
        part.component = component;
    } else if (role != "-") {
        // A float* holds as many numbers as its role needs.
        if (part.points_to_numbers) part.is_vector = !is_number;
        else if (is_number && part.is_vector) fail("is a number, but " + part.path + " is a vector");
        else if (!is_number && !part.is_vector) {
            if (!are_input_numbers(parts, i))
                fail("is a vector, but " + part.path + " is a number, and not the first of three");
            join_numbers(parts, i, part.last_name);
        }
    }
    const bool is_repeated =
        role != "-" && std::ranges::any_of(parts, [&](const ArgumentPart& other) {
            return other.role == role && (component < 0 || other.component < 0 || other.component == component);
        });
    if (is_repeated)
        fail(
            "is named twice; a vector is named once, also if its x, y and z are three arguments, or by its "
            "components, such as o.x, o.y, o.z");
    part.role = role;
    part.is_out = is_answer_role(role) || (role == "-" && part.is_out);
}

/// Throws InputError if a number or a vector that the function reads has no role, or if a vector lacks a component.
void require_complete_roles(const std::vector<ArgumentPart>& parts, const StatedSignature& stated) {
    for (const ArgumentPart& part : parts) {
        if (part.role.empty() && !part.is_out && !part.slot.is_integer && !part.points_to_numbers)
            throw InputError(stated.message_prefix + ": names " + std::to_string(stated.roles.size()) +
                             " arguments, and none for " + part.path +
                             "; name each number and vector in order, or write - for one without a meaning");
        const auto component_count =
            std::ranges::count_if(parts, [&part](const ArgumentPart& other) { return other.role == part.role; });
        if (part.component >= 0 && component_count != 3)
            throw InputError(stated.message_prefix + ": " + part.path +
                             " is a component of a vector, and the vector has no other ones; name all of x, y and z");
    }
}

}  // namespace

void apply_stated_roles(std::vector<ArgumentPart>& parts, Shape shape, const StatedSignature& stated) {
    // If the comment names more arguments than there are parts, it names fourth numbers too.
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k].has_fourth && stated.roles.size() > parts.size())
            parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(k) + 1, fourth_number_of(parts[k]));
    for (std::size_t i = 0; i < stated.roles.size(); ++i) {
        if (i >= parts.size())
            throw InputError(stated.message_prefix + ": names " + external::quote_text(stated.roles[i]) +
                             ", but the function takes only " + std::to_string(parts.size()) +
                             " vectors and numbers before it");
        apply_stated_role(parts, i, shape, stated);
    }
    require_complete_roles(parts, stated);
}

}  // namespace lostbits::intersect::function
