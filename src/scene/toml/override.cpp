// Applies overrides, which variants, `--set` and sweep axes all use.
#include <algorithm>
#include <charconv>
#include <string_view>

#include "scene/toml/former_names.hpp"
#include "scene/toml/toml_tree.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::toml {
namespace {

/// Part of a path: a key or, with `is_index`, an index of an array. `end` is the end of the part in the path.
struct PathPart {
    bool is_index;
    std::string key;
    std::size_t index;
    std::size_t end;
};

std::vector<PathPart> parts_of_path(const Override& change) {
    const std::string& path = change.path;
    const auto fail_malformed = [&](const std::string& why) {
        fail(change.where,
             "the path \"" + path + "\" " + why + "; write keys and indices from 0, as in sphere[0].radius");
    };
    std::vector<PathPart> parts;
    std::size_t i = 0;
    while (true) {
        const std::size_t end = std::min(path.find_first_of(".[", i), path.size());
        if (end == i) fail_malformed("has an empty key");
        parts.push_back({false, std::string(current_table_name(std::string_view(path).substr(i, end - i))), 0, end});
        i = end;

        // A key may have indices behind it, as in `sphere[0].centre[2]`.
        while (i < path.size() && path[i] == '[') {
            std::size_t index = 0;
            const auto [stop, error] = std::from_chars(path.data() + i + 1, path.data() + path.size(), index);
            if (error != std::errc{} || stop == path.data() + path.size() || *stop != ']')
                fail_malformed(error == std::errc::result_out_of_range ? "has an index that is too large"
                                                                       : "has an index that is not a whole number");
            i = static_cast<std::size_t>(stop - path.data()) + 1;
            parts.push_back({true, "", index, i});
        }

        if (i == path.size()) return parts;
        if (path[i] != '.') fail_malformed("continues after an index without a dot");
        ++i;
    }
}

/// Advice for a key of an array: the text to write after the array, `[0].key` for tables, or the index of x, y or z.
std::string array_access(const Node& array, const std::string& key) {
    if (array.items.empty() || array.items.front().kind == Node::Kind::table) return "[0]." + key;
    const std::size_t coordinate = key.size() == 1 ? std::string_view("xyz").find(key) : std::string_view::npos;
    return "[" + std::to_string(coordinate == std::string_view::npos ? 0 : coordinate) + "]";
}

/// Returns the item of an array with the index of a path. Otherwise fails; `unknown` and `location` begin the message.
Node& find_item(Node& node, const PathPart& part, const Override& change, const std::string& unknown,
                const std::string& location) {
    if (node.kind != Node::Kind::array)
        fail(change.where, unknown + location + " is " + node.describe() + ", which has no indices; leave [...] out");
    if (part.index >= node.items.size()) {
        const std::string advice =
            node.items.empty() ? "" : "; indices go from 0 to " + std::to_string(node.items.size() - 1);
        fail(change.where, unknown + location + " is " + node.describe() + advice);
    }
    node.where = change.where;  // errors about the whole value now name the override
    return node.items[part.index];
}

/// Returns the value of a key of a table. The last key of a path is added if the table lacks it.
Node& find_or_add_value(Node& node, const PathPart& part, bool is_last, const Override& change,
                        const std::string& unknown, const std::string& location) {
    if (node.kind == Node::Kind::array)
        fail(change.where,
             unknown + location + " is " + node.describe() + "; say which: " + location + array_access(node, part.key));
    if (node.kind != Node::Kind::table)
        fail(change.where, unknown + location + " is " + node.describe() + ", which has no keys; end the path there");

    if (Node* const value = node.find(part.key)) return *value;
    if (!is_last) {
        const std::string hint = text::did_you_mean(part.key, node.keys());
        fail(change.where, unknown + location + " has no \"" + part.key + '"' + (hint.empty() ? "" : "; " + hint));
    }
    node.entries.push_back({part.key, change.where, {}});
    return node.entries.back().value;
}

}  // namespace

void apply_override(Node& root, const Override& change) {
    const std::vector<PathPart> parts = parts_of_path(change);
    const std::string unknown = "unknown path \"" + change.path + "\": ";
    Node* node = &root;
    std::string location = "the file";  // for errors: the path to `node`
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const PathPart& part = parts[i];
        const bool is_last = i + 1 == parts.size();
        node = part.is_index ? &find_item(*node, part, change, unknown, location)
                             : &find_or_add_value(*node, part, is_last, change, unknown, location);
        location = change.path.substr(0, part.end);
    }
    *node = change.value;
}

std::vector<Override> read_overrides(const Node& table) {
    std::vector<Override> overrides;
    for (const Node::Entry& entry : table.entries) {
        if (entry.value.kind != Node::Kind::table) {
            overrides.push_back({entry.key, entry.value, entry.key_where});
            continue;
        }
        for (Override& inner : read_overrides(entry.value))
            overrides.push_back({entry.key + '.' + inner.path, std::move(inner.value), inner.where});
    }
    return overrides;
}

}  // namespace lostbits::scene::toml
