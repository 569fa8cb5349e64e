// Type of a number in a binary file: its kind, its size in bytes and the order of the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "number/format.hpp"

namespace lostbits::scene::ray_file {

struct ItemType {
    enum class Kind : std::uint8_t { floating, signed_integer, unsigned_integer, boolean };
    Kind kind = Kind::floating;
    std::uint8_t size = 4;  ///< in bytes: 2, 4 or 8 for floats, 1 to 8 for integers, 1 for booleans
    bool is_big_endian = false;

    struct DecodedItem {
        double value;
        bool exact;  ///< true if a double holds the number exactly
    };
    [[nodiscard]] DecodedItem read(const char* bytes) const;
    /// The shortest decimal that reads back to the same number.
    [[nodiscard]] std::string text(const char* bytes) const;
    /// `f32`, `f64be`, `bool`: the name by which `find_item_type` finds it.
    [[nodiscard]] std::string name() const;
    /// The format of floats of this type; nothing for other types.
    [[nodiscard]] std::optional<Format> format() const;
    friend bool operator==(const ItemType&, const ItemType&) = default;
};

/// Finds a type by `f32`, `f64be`, `u8`, `i64le`, `bool`, or as numpy writes it: `<f4`, `>f8`, `|u1`, `|b1`, `?`. If
/// the byte order is not given, the least significant byte comes first. Returns nothing for any other text.
std::optional<ItemType> find_item_type(std::string_view word);

/// Advice for an unknown type.
inline constexpr std::string_view item_type_advice =
    "f16, f32, f64, i8 to i64, u8 to u64 or bool, followed by be if the most significant byte comes first";

}  // namespace lostbits::scene::ray_file
