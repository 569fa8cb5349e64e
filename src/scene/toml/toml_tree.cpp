#include "scene/toml/toml_tree.hpp"

#include <algorithm>
#include <utility>

#include <toml++/toml.h>

#include "scene/toml/byte_source.hpp"
#include "scene/toml/former_names.hpp"
#include "scene/toml/parse_number.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::toml {
namespace {

constexpr std::size_t max_bytes = std::size_t{16} << 20;

/// Converts toml++'s tree to ours. A float is read again from the text, because toml++ keeps only the nearest double.
class Converter {
public:
    Converter(std::string_view text, std::string source) : source_(std::move(source)) {
        while (true) {
            const std::size_t end = text.find('\n');
            lines_.push_back(text.substr(0, end));
            if (end == std::string_view::npos) break;
            text.remove_prefix(end + 1);
        }
    }

    [[nodiscard]] Node convert(const ::toml::node& source) const {
        Node node;
        node.where = position_of(source.source());

        // Values that hold others.
        if (const auto* table = source.as_table()) {
            node.kind = Node::Kind::table;
            for (auto&& [key, value] : *table)
                node.entries.push_back(
                    {std::string(current_table_name(key.str())), position_of(key.source()), convert(value)});
            // toml++ sorts by name, but overrides apply in the order of writing.
            std::stable_sort(node.entries.begin(), node.entries.end(), [](const Node::Entry& a, const Node::Entry& b) {
                return std::pair(a.key_where.line, a.key_where.column) <
                       std::pair(b.key_where.line, b.key_where.column);
            });
        } else if (const auto* array = source.as_array()) {
            node.kind = Node::Kind::array;
            for (const ::toml::node& item : *array) node.items.push_back(convert(item));
        } else if (const auto* string = source.as_string()) {
            node.kind = Node::Kind::string;
            node.text = current_name(string->get());
        } else if (const auto* integer = source.as_integer()) {
            node.kind = Node::Kind::integer;
            node.integer = integer->get();
        } else if (source.is_floating_point()) {
            node.kind = Node::Kind::floating;
            node.text = digits_at(node.where);
        } else if (const auto* boolean = source.as_boolean()) {
            node.kind = Node::Kind::boolean;
            node.boolean = boolean->get();
        }
        return node;
    }

private:
    [[nodiscard]] SourcePosition position_of(const ::toml::source_region& region) const {
        return {source_, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
    }

    [[nodiscard]] std::string digits_at(const SourcePosition& where) const {
        const std::string_view line = lines_.at(static_cast<std::size_t>(where.line) - 1);
        std::size_t byte = byte_of(where, line);
        constexpr std::string_view number_characters = "0123456789+-._eEinfa";
        std::string digits;
        for (; byte < line.size() && number_characters.find(line[byte]) != std::string_view::npos; ++byte)
            if (line[byte] != '_') digits += line[byte];
        return digits;
    }

    /// Returns the byte of a column. Columns count characters, so the continuation bytes of UTF-8 are not counted. A
    /// million numbers may be in one line, so the starts of the characters of the last line are stored.
    [[nodiscard]] std::size_t byte_of(const SourcePosition& where, std::string_view line) const {
        if (where.line != counted_line_) {
            counted_line_ = where.line;
            character_begins_.clear();
            for (std::uint32_t byte = 0; byte < line.size(); ++byte)
                if ((line[byte] & 0xc0) != 0x80) character_begins_.push_back(byte);
        }
        const auto column = static_cast<std::size_t>(where.column) - 1;
        return column < character_begins_.size() ? character_begins_[column] : line.size();
    }

    std::string source_;
    std::vector<std::string_view> lines_;
    mutable int counted_line_ = 0;
    mutable std::vector<std::uint32_t> character_begins_;  ///< bytes at which the characters of `counted_line_` begin
};

Node parse(std::string_view text, const std::string& source) {
    // A byte order mark is not a character of the first line.
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    try {
        const ::toml::table table = ::toml::parse(text, std::string_view(source));
        return Converter(text, source).convert(table);
    } catch (const ::toml::parse_error& error) {
        const auto& begin = error.source().begin;
        std::string description(error.description());
        std::string remedy = "; see https://toml.io for the notation";
        if (description.find("hexadecimal floating-point") != std::string::npos)
            remedy = R"(; write a hexadecimal float as a string: "0x1.004p+12")";
        fail({source, static_cast<int>(begin.line), static_cast<int>(begin.column)},
             "not valid TOML: " + description + remedy);
    }
}

}  // namespace

std::string SourcePosition::text() const {
    return line == 0 ? source : source + ':' + std::to_string(line) + ':' + std::to_string(column);
}

void fail(const SourcePosition& where, const std::string& message) { throw InputError(where.text() + ": " + message); }

const Node* Node::find(std::string_view key) const {
    for (const Entry& entry : entries)
        if (entry.key == key) return &entry.value;
    return nullptr;
}

Node* Node::find(std::string_view key) { return const_cast<Node*>(std::as_const(*this).find(key)); }

std::vector<std::string> Node::keys() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries) names.push_back(entry.key);
    return names;
}

std::string Node::describe() const {
    switch (kind) {
        case Kind::table: return "a table";
        case Kind::array: return "an array of " + std::to_string(items.size());
        case Kind::string: return "the string " + text::quoted_excerpt(text);
        case Kind::integer: return "the integer " + std::to_string(integer);
        case Kind::floating: return "the number " + text;
        case Kind::boolean: return boolean ? "the boolean true" : "the boolean false";
        case Kind::other: break;
    }
    return "a date or time";
}

Node Node::of_string(std::string text, SourcePosition where) {
    Node node;
    node.kind = Kind::string;
    node.where = std::move(where);
    node.text = std::move(text);
    return node;
}

Node Node::of_integer(std::int64_t value, SourcePosition where) {
    Node node;
    node.kind = Kind::integer;
    node.where = std::move(where);
    node.integer = value;
    return node;
}

Node Node::of_number(const Real& value, SourcePosition where) { return of_string(exact_text(value), std::move(where)); }

Node Node::of_array(std::vector<Node> items, SourcePosition where) {
    Node node;
    node.kind = Kind::array;
    node.where = std::move(where);
    node.items = std::move(items);
    return node;
}

namespace {

/// Fails for a very long key: toml++ 3.3 recurses once for each part of a dotted key, and overflows the stack on a key
/// of 50000 parts.
void require_no_long_keys(const std::string& text, const std::string& source) {
    constexpr int max_parts = 256;
    int line = 1, dots = 0;
    for (const char c : text) {
        if (c == '\n') ++line;
        if (c == '\n' || c == '=' || c == ',' || c == '{') dots = 0;
        else if (c == '.' && ++dots > max_parts)
            fail({source, line, 1}, "has a key of more than 256 parts; check that this is the right file");
    }
}

}  // namespace

Node read_toml(const std::filesystem::path& path, intersect::process::StopToken stop) {
    const SourcePosition start{path.string(), 1, 1}, unread{path.string(), 0, 0};
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) fail(unread, "is a folder; name a .toml file in it");
    ByteSource file(path, stop);
    std::string text;
    file.read(text, max_bytes + 1);
    if (text.size() > max_bytes) fail(start, "is larger than 16 MiB; check that this is the right file");
    require_no_long_keys(text, start.source);
    return parse(text, start.source);
}

Override parse_override(std::string_view assignment, std::string_view option) {
    const SourcePosition where{std::string(option) + ' ' + std::string(assignment), 0, 0};
    const std::size_t equals_sign = assignment.find('=');
    if (equals_sign == std::string_view::npos || equals_sign == 0)
        fail(where, "is not an assignment; write path=value, as in sphere[0].radius=1e3");
    const auto trimmed = [](std::string_view s) {
        while (!s.empty() && s.front() == ' ') s.remove_prefix(1);
        while (!s.empty() && s.back() == ' ') s.remove_suffix(1);
        return s;
    };
    const std::string path(trimmed(assignment.substr(0, equals_sign)));
    const std::string text(trimmed(assignment.substr(equals_sign + 1)));
    if (text.empty()) fail(where, "has no value after =; write path=value, as in sphere[0].radius=1e3");

    Node value = Node::of_string(text, where);
    if (text.find('\n') == std::string::npos) {
        try {
            value = parse("value = " + text, "").entries.at(0).value;
        } catch (const InputError&) {
            // The text is not TOML: it is a bare word or a hexadecimal float. The reader of the key handles it as a
            // string.
        }
    }
    // The option is the position, so no column inside the value is reported.
    const auto set_position = [&where](auto&& self, Node& node) -> void {
        node.where = where;
        for (Node& item : node.items) self(self, item);
        for (Node::Entry& entry : node.entries) {
            entry.key_where = where;
            self(self, entry.value);
        }
    };
    set_position(set_position, value);
    return {path, std::move(value), where};
}

}  // namespace lostbits::scene::toml
