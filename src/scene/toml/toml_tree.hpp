// Reads a TOML file into a tree of our own. Every value has the position at which it was written and, for a float, the
// digits as written. Only toml_tree.cpp uses toml++.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"
#include "number/real.hpp"

namespace lostbits::scene::toml {

/// A position in a file (line and column from 1, columns in characters) or, with line 0, an option of the command
/// line.
struct SourcePosition {
    std::string source;
    int line = 0;
    int column = 0;
    [[nodiscard]] std::string text() const;  ///< returns `file:line:col`, or the option alone
};

/// Throws InputError `where: message`.
[[noreturn]] void fail(const SourcePosition& where, const std::string& message);

/// One value. The set of kinds is closed; dates have the kind `other`, because no key uses them.
struct Node {
    enum class Kind { table, array, string, integer, floating, boolean, other };
    struct Entry;

    Kind kind = Kind::other;
    SourcePosition where;
    std::string text;  ///< string: its contents; floating: its digits as written, without underscores
    std::int64_t integer = 0;
    bool boolean = false;
    std::vector<Node> items;     ///< array
    std::vector<Entry> entries;  ///< table, in the order of writing

    [[nodiscard]] const Node* find(std::string_view key) const;
    [[nodiscard]] Node* find(std::string_view key);
    [[nodiscard]] std::vector<std::string> keys() const;
    /// Describes the value for an error: `the string "abc"`, `an array of 3`, …
    [[nodiscard]] std::string describe() const;

    static Node of_string(std::string text, SourcePosition where);
    static Node of_integer(std::int64_t value, SourcePosition where);
    static Node of_number(const Real& value, SourcePosition where);
    static Node of_array(std::vector<Node> items, SourcePosition where);
};

struct Node::Entry {
    std::string key;
    SourcePosition key_where;
    Node value;
};

/// Parses a file. Throws InputError with a position if it is missing, a folder, over 16 MiB or not TOML,
/// EnvironmentError if it is not readable, and Interrupted if it is stopped, also while a pipe has no bytes.
Node read_toml(const std::filesystem::path& path, intersect::process::StopToken stop = {});

/// A change to a tree before the tree is interpreted. Variants, `--set` and sweep axes are lists of such changes.
struct Override {
    std::string path;  ///< `sphere[0].radius`, `camera.eye`, `sphere[0].centre[2]`: keys and indices from 0
    Node value;
    SourcePosition where;  ///< position of the path, for errors
};

/// Reads `path=value` with the value in TOML's notation. A text that is not TOML is taken as a string
/// (`camera.kind=pinhole`). Errors start with `option` and the text itself.
Override parse_override(std::string_view assignment, std::string_view option = "--set");

/// Sets the value at the path. The last key of a path may be new to its table; the reader of the table decides whether
/// it is known. All earlier parts of the path must exist; otherwise throws InputError with did-you-mean.
void apply_override(Node& root, const Override& change);

/// Returns the overrides of a table of `"path" = value`. Plain tables inside it extend the path.
std::vector<Override> read_overrides(const Node& table);

}  // namespace lostbits::scene::toml
