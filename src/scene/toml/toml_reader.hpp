// Reads tables of TOML files (scenes, sweeps and claims) with the types of their keys. Every error says where and what
// is wrong, why, and what to try.
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/vec.hpp"
#include "number/real.hpp"
#include "scene/toml/toml_tree.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::toml {

/// Reads one table, key by key, and records which keys were requested. At the end, `require_known_keys` reports all
/// other keys as mistakes. `x(key)` requires the key, `optional_x(key)` does not. Throws InputError at the value for a
/// key of the wrong type and for a number that is not finite, and InputError at the table for a missing key. The tree
/// must outlive the reader.
class TableReader {
    template <class T, class... Args>
    std::optional<T> optional(std::string_view key, T (TableReader::*reader)(std::string_view, Args...), Args... args) {
        return has(key) ? std::optional<T>((this->*reader)(key, args...)) : std::nullopt;
    }

public:
    /// `path` is the name of the table in errors and overrides: `camera`, `sphere[0]`, empty for the file itself.
    explicit TableReader(const Node& table, std::string path = "");

    std::string string(std::string_view key);
    /// Reads a string that pictures show, with a limit on its length.
    std::string title(std::string_view key);
    static constexpr std::size_t max_title_bytes = 400;  ///< a dozen lines on the narrowest sheet
    std::optional<std::string> optional_string(std::string_view key) { return optional(key, &TableReader::string); }
    std::vector<std::string> strings(std::string_view key);
    std::optional<std::vector<std::string>> optional_strings(std::string_view key) {
        return optional(key, &TableReader::strings);
    }
    std::optional<bool> optional_boolean(std::string_view key);

    /// A whole number in [lowest, highest].
    long long integer(std::string_view key, long long lowest, long long highest);
    std::optional<long long> optional_integer(std::string_view key, long long lowest, long long highest) {
        return optional(key, &TableReader::integer, lowest, highest);
    }
    /// Exactly `count` whole numbers in [lowest, highest].
    std::optional<std::vector<long long>> optional_integers(std::string_view key, std::size_t count, long long lowest,
                                                            long long highest);

    /// A TOML integer or float, or a string: a decimal or a hexadecimal float. It is read exactly and rounded once
    /// (`parse_number`): 0.1 and "0.1" are both one tenth, not the nearest double.
    Real number(std::string_view key);
    std::optional<Real> optional_number(std::string_view key) { return optional(key, &TableReader::number); }
    /// Sets `x` to the number in [lowest, highest], if the key is present.
    void read_number(std::string_view key, double& x, double lowest, double highest);
    /// `count` numbers; if count = 0, one or more numbers.
    std::vector<Real> numbers(std::string_view key, std::size_t count = 0);
    std::optional<std::vector<Real>> optional_numbers(std::string_view key, std::size_t count = 0) {
        return optional(key, &TableReader::numbers, count);
    }
    Vec<Real> vec3(std::string_view key);
    std::optional<Vec<Real>> optional_vec3(std::string_view key) { return optional(key, &TableReader::vec3); }

    /// A string that is one of the given names.
    template <class E>
    E one_of(std::string_view key, std::span<const std::pair<std::string_view, E>> choices) {
        return choices[index_of_choice(key, names_of(choices))].second;
    }
    template <class E>
    std::optional<E> optional_one_of(std::string_view key, std::span<const std::pair<std::string_view, E>> choices) {
        return has(key) ? std::optional(one_of(key, choices)) : std::nullopt;
    }

    /// Sets `x` to the value of the key, if it is present. The default is documented at `x`.
    void read(std::string_view key, std::string& x);
    void read(std::string_view key, bool& x);
    void read(std::string_view key, Vec<Real>& x);
    /// A whole number in [lowest, highest].
    template <std::integral I>
    void read(std::string_view key, I& x, long long lowest, long long highest) {
        if (has(key)) x = static_cast<I>(integer(key, lowest, highest));
    }
    template <class E>
    void read(std::string_view key, E& x,
              std::span<const std::pair<std::string_view, std::type_identity_t<E>>> choices) {
        if (has(key)) x = one_of(key, choices);
    }

    [[nodiscard]] bool has(std::string_view key) { return request(key) != nullptr; }
    /// Names of all keys, in the order of the file.
    [[nodiscard]] std::vector<std::string> keys() const { return table_->keys(); }
    /// Returns the value itself, for a notation of its own. `expected` says what to write if the value is missing.
    const Node& node(std::string_view key, std::string_view expected = "a value");

    TableReader table(std::string_view key);
    std::optional<TableReader> optional_table(std::string_view key) { return optional(key, &TableReader::table); }
    /// Returns the elements of an array of tables, `[[key]]`; none if the key is missing.
    std::vector<TableReader> tables(std::string_view key);

    /// Rejects a key that has no meaning here. `why` continues the sentence after `path.key`.
    void reject(std::string_view key, std::string_view why);
    /// Throws InputError with did-you-mean for every key that was not requested. Call this last.
    void require_known_keys() const;

    /// Position of the value, or of the table if the key is missing.
    [[nodiscard]] SourcePosition where(std::string_view key) const;
    [[nodiscard]] SourcePosition where() const { return table_->where; }
    /// Path of a key, as in `camera.eye`.
    [[nodiscard]] std::string path_to(std::string_view key) const;
    /// Throws InputError `file:line:col: path.key message`.
    [[noreturn]] void fail_at(std::string_view key, const std::string& message) const;

private:
    const Node* request(std::string_view key);
    const Node& require(std::string_view key, std::string_view expected);
    std::size_t index_of_choice(std::string_view key, const std::vector<std::string>& names);

    template <class E>
    static std::vector<std::string> names_of(std::span<const std::pair<std::string_view, E>> choices) {
        std::vector<std::string> names;
        for (const auto& entry : choices) names.emplace_back(entry.first);
        return names;
    }

    const Node* table_;
    std::string path_;
    std::vector<std::string> requested_keys_;
};

/// Checks the key `schema` of a file against e.g. "lostbits-scene/1". Throws InputError if the schema is missing,
/// different or newer.
void require_schema(TableReader& file, std::string_view schema);

}  // namespace lostbits::scene::toml
