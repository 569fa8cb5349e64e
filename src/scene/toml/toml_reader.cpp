#include "scene/toml/toml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "scene/toml/parse_number.hpp"

namespace lostbits::scene::toml {
namespace {

using Kind = Node::Kind;

[[noreturn]] void fail_for_type(const Node& node, const std::string& name, std::string_view expected) {
    fail(node.where, name + " is " + node.describe() + ", but " + std::string(expected) + " is expected here");
}

void require_kind(const Node& node, Kind kind, const std::string& name, std::string_view expected) {
    if (node.kind != kind) fail_for_type(node, name, expected);
}

std::string element(const std::string& name, std::size_t i) { return name + '[' + std::to_string(i) + ']'; }

constexpr std::string_view a_string = "a string";
constexpr std::string_view a_number = R"(a number (4100, 1e-3, "0x1.004p+12"))";

Real as_number(const Node& node, const std::string& name) {
    if (node.kind == Kind::integer) return Real(node.integer);
    if (node.kind != Kind::string && node.kind != Kind::floating) fail_for_type(node, name, a_number);
    const auto parsed = parse_number(node.text);
    if (const auto* fault = std::get_if<NumberFault>(&parsed)) {
        fail(node.where, name + " = " + (node.kind == Kind::string ? text::quoted_excerpt(node.text) : node.text) +
                             ' ' + fault->why);
    }
    return std::get<Real>(parsed);
}

long long as_integer(const Node& node, const std::string& name, long long lowest, long long highest) {
    const std::string range = "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest);
    require_kind(node, Kind::integer, name, range);
    if (node.integer < lowest || node.integer > highest) fail_for_type(node, name, range);
    return node.integer;
}

std::string array_phrase(std::size_t count, std::string_view element_name) {
    return count == 0 ? "an array of " + std::string(element_name)
                      : "an array of " + std::to_string(count) + ' ' + std::string(element_name);
}

const std::vector<Node>& as_array(const Node& node, const std::string& name, std::size_t count,
                                  std::string_view element_name) {
    const bool has_right_length = count == 0 ? !node.items.empty() : node.items.size() == count;
    if (node.kind != Kind::array || !has_right_length) fail_for_type(node, name, array_phrase(count, element_name));
    return node.items;
}

std::vector<Real> as_numbers(const Node& node, const std::string& name, std::size_t count) {
    std::vector<Real> values;
    for (const Node& item : as_array(node, name, count, "numbers"))
        values.push_back(as_number(item, element(name, values.size())));
    return values;
}

/// Returns the text of a string without control characters. Text goes to terminals, tables and pages, and a character
/// that a terminal would obey is a mistake, or worse.
const std::string& as_text(const Node& node, const std::string& name) {
    require_kind(node, Kind::string, name, a_string);
    unsigned char previous_byte = 0;
    for (const char c : node.text) {
        const auto byte = static_cast<unsigned char>(c);
        // U+0080 to U+009F, which are \xC2 followed by a byte in this range, have the effect of ESC and a letter:
        // U+009B is ESC [.
        const bool is_c1_control = previous_byte == 0xC2 && byte >= 0x80 && byte < 0xA0;
        previous_byte = byte;
        if (!is_c1_control && ((byte >= ' ' && byte != 0x7F) || c == '\n' || c == '\t')) continue;
        fail(node.where, name + " holds the control character " + std::to_string(byte) +
                             ", which a terminal would obey; leave it out");
    }
    return node.text;
}

std::vector<std::string> as_strings(const Node& node, const std::string& name) {
    std::vector<std::string> values;
    for (const Node& item : as_array(node, name, 0, "strings")) {
        values.push_back(as_text(item, element(name, values.size())));
    }
    return values;
}

}  // namespace

TableReader::TableReader(const Node& table, std::string path) : table_(&table), path_(std::move(path)) {
    require_kind(table, Kind::table, path_.empty() ? "the file" : path_, "a table");
}

std::string TableReader::path_to(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + '.' + std::string(key);
}

SourcePosition TableReader::where(std::string_view key) const {
    const Node* node = table_->find(key);
    return node == nullptr ? table_->where : node->where;
}

void TableReader::fail_at(std::string_view key, const std::string& message) const {
    fail(where(key), path_to(key) + ' ' + message);
}

const Node* TableReader::request(std::string_view key) {
    if (std::find(requested_keys_.begin(), requested_keys_.end(), key) == requested_keys_.end())
        requested_keys_.emplace_back(key);
    return table_->find(key);
}

const Node& TableReader::require(std::string_view key, std::string_view expected) {
    const Node* node = request(key);
    if (node != nullptr) return *node;
    const std::string missing = path_to(key) + " is missing";
    // A misspelt key shows up as a missing key first, so the error points at the misspelling.
    std::vector<std::string> unread;
    for (const std::string& present : table_->keys())
        if (std::find(requested_keys_.begin(), requested_keys_.end(), present) == requested_keys_.end())
            unread.push_back(present);
    if (const auto closest_key = text::closest(key, unread)) {
        for (const Node::Entry& entry : table_->entries)
            if (entry.key == *closest_key)
                fail(entry.key_where, missing + ", but there is " + path_to(*closest_key) + "; did you mean \"" +
                                          std::string(key) + "\"?");
    }
    fail(table_->where, missing + (expected == a_string ? "; add " + std::string(key) + " = \"...\""
                                                        : "; give it " + std::string(expected)));
}

std::string TableReader::string(std::string_view key) { return as_text(require(key, a_string), path_to(key)); }

std::string TableReader::title(std::string_view key) {
    std::string text = string(key);
    if (text.size() > max_title_bytes)
        fail_at(key,
                fmt::format(
                    "has {} bytes, but every picture shows it; use at most {}, and put the rest into note = \"...\"",
                    text.size(), max_title_bytes));
    return text;
}

std::vector<std::string> TableReader::strings(std::string_view key) {
    return as_strings(require(key, "an array of strings"), path_to(key));
}

std::optional<bool> TableReader::optional_boolean(std::string_view key) {
    const Node* node = request(key);
    if (node == nullptr) return std::nullopt;
    require_kind(*node, Kind::boolean, path_to(key), "true or false");
    return node->boolean;
}

long long TableReader::integer(std::string_view key, long long lowest, long long highest) {
    return as_integer(require(key, "a whole number"), path_to(key), lowest, highest);
}

std::optional<std::vector<long long>> TableReader::optional_integers(std::string_view key, std::size_t count,
                                                                     long long lowest, long long highest) {
    const Node* node = request(key);
    if (node == nullptr) return std::nullopt;
    std::vector<long long> values;
    for (const Node& item : as_array(*node, path_to(key), count, "whole numbers"))
        values.push_back(as_integer(item, element(path_to(key), values.size()), lowest, highest));
    return values;
}

Real TableReader::number(std::string_view key) { return as_number(require(key, a_number), path_to(key)); }

void TableReader::read_number(std::string_view key, double& x, double lowest, double highest) {
    x = static_cast<double>(optional_number(key).value_or(Real(x)));
    if (!(x >= lowest && x <= highest)) fail_at(key, fmt::format("must lie between {} and {}", lowest, highest));
}

std::vector<Real> TableReader::numbers(std::string_view key, std::size_t count) {
    return as_numbers(require(key, array_phrase(count, "numbers")), path_to(key), count);
}

Vec<Real> TableReader::vec3(std::string_view key) {
    const std::vector<Real> xyz = numbers(key, 3);
    return {xyz[0], xyz[1], xyz[2]};
}

std::size_t TableReader::index_of_choice(std::string_view key, const std::vector<std::string>& names) {
    const Node& node = require(key, fmt::format("one of \"{}\"", fmt::join(names, "\", \"")));
    const std::string& name = as_text(node, path_to(key));
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        fail_at(key, "is " + text::quoted_excerpt(name) + ", which is not known; " + text::did_you_mean(name, names));
    return static_cast<std::size_t>(found - names.begin());
}

void TableReader::read(std::string_view key, std::string& x) {
    if (has(key)) x = string(key);
}
void TableReader::read(std::string_view key, bool& x) { x = optional_boolean(key).value_or(x); }
void TableReader::read(std::string_view key, Vec<Real>& x) {
    if (has(key)) x = vec3(key);
}

const Node& TableReader::node(std::string_view key, std::string_view expected) { return require(key, expected); }

TableReader TableReader::table(std::string_view key) {
    return TableReader(require(key, "a table of that name"), path_to(key));
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
    std::vector<TableReader> readers;
    const Node* node = request(key);
    if (node == nullptr) return readers;
    const std::string expected = "an array of tables, [[" + path_to(key) + "]],";
    require_kind(*node, Kind::array, path_to(key), expected);
    for (const Node& item : node->items) {
        require_kind(item, Kind::table, element(path_to(key), readers.size()), "a table");
        readers.emplace_back(item, element(path_to(key), readers.size()));
    }
    return readers;
}

void TableReader::reject(std::string_view key, std::string_view why) {
    for (const Node::Entry& entry : table_->entries)
        if (entry.key == key) fail(entry.key_where, path_to(key) + ' ' + std::string(why));
}

void TableReader::require_known_keys() const {
    for (const Node::Entry& entry : table_->entries) {
        if (std::find(requested_keys_.begin(), requested_keys_.end(), entry.key) != requested_keys_.end()) continue;
        fail(entry.key_where, "unknown key " + path_to(text::excerpt(entry.key)) + "; " +
                                  text::did_you_mean(entry.key, requested_keys_));
    }
}

void require_schema(TableReader& file, std::string_view schema) {
    const std::string expected = "schema = \"" + std::string(schema) + '"';
    if (!file.optional_string("schema"))
        fail(file.where(), "schema is missing, so the meaning of the keys is unknown; write " + expected + " first");
    const std::string found = file.string("schema");
    if (found == schema) return;

    const auto split = [](std::string_view name) {
        const std::size_t slash = std::min(name.find('/'), name.size());
        long long version = 0;
        if (slash < name.size()) std::from_chars(name.data() + slash + 1, name.data() + name.size(), version);
        return std::pair(name.substr(0, slash), version);
    };
    const auto [kind, version] = split(found);
    const auto [expected_kind, newest_version] = split(schema);
    if (kind == expected_kind && version > newest_version)
        file.fail_at("schema", "is " + text::quoted_excerpt(found) +
                                   ", newer than this program reads; use a newer lostbits, or write " + expected);
    file.fail_at("schema", "is " + text::quoted_excerpt(found) + ", which is another kind of file than " +
                               text::quoted_excerpt(schema) + ", expected here; name a file of that kind");
}

}  // namespace lostbits::scene::toml
