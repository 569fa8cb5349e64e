#include "scene/ray_file/item_type.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace lostbits::scene::ray_file {

static_assert(std::endian::native == std::endian::little);

namespace {

/// Returns the bytes as an unsigned number.
std::uint64_t bits_of(const char* bytes, std::size_t size, bool is_big_endian) {
    std::array<char, 8> little_endian{};
    for (std::size_t i = 0; i < size; ++i) little_endian[i] = bytes[is_big_endian ? size - 1 - i : i];
    return std::bit_cast<std::uint64_t>(little_endian);
}

double binary16_value(std::uint64_t bits) {
    const double sign = (bits & 0x8000) != 0 ? -1 : 1;
    const int exponent = static_cast<int>(bits >> 10 & 31);
    const auto fraction = static_cast<double>(bits & 1023);
    if (exponent == 31) return fraction == 0 ? sign * HUGE_VAL : std::numeric_limits<double>::quiet_NaN();
    return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

template <class N>
std::string shortest_decimal(N number) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string shortest_float_text(double value, bool is_binary32) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
    return is_binary32 ? shortest_decimal(static_cast<float>(value)) : shortest_decimal(value);
}

std::int64_t extend_sign(std::uint64_t bits, std::size_t size) {
    const auto unused = static_cast<int>(64 - 8 * size);
    return static_cast<std::int64_t>(bits << unused) >> unused;
}

}  // namespace

ItemType::DecodedItem ItemType::read(const char* bytes) const {
    // The most frequent type is read without a loop over its bytes.
    if (kind == Kind::floating && !is_big_endian && size == 4) {
        float value;
        std::memcpy(&value, bytes, 4);
        return {value, true};
    }

    const std::uint64_t bits = bits_of(bytes, size, is_big_endian);
    switch (kind) {
        case Kind::floating:
            if (size == 2) return {binary16_value(bits), true};
            if (size == 4) return {std::bit_cast<float>(static_cast<std::uint32_t>(bits)), true};
            return {std::bit_cast<double>(bits), true};
        case Kind::signed_integer: {
            const std::int64_t whole = extend_sign(bits, size);
            return {static_cast<double>(whole),
                    size < 8 || (whole >= -(std::int64_t{1} << 53) && whole <= std::int64_t{1} << 53)};
        }
        case Kind::unsigned_integer: return {static_cast<double>(bits), size < 8 || bits <= std::uint64_t{1} << 53};
        case Kind::boolean: break;
    }
    return {bits != 0 ? 1.0 : 0.0, true};
}

std::string ItemType::text(const char* bytes) const {
    const std::uint64_t bits = bits_of(bytes, size, is_big_endian);
    switch (kind) {
        case Kind::floating: return shortest_float_text(read(bytes).value, size == 4);
        case Kind::signed_integer: return shortest_decimal(extend_sign(bits, size));
        case Kind::unsigned_integer: return shortest_decimal(bits);
        case Kind::boolean: break;
    }
    return bits != 0 ? "1" : "0";
}

std::string ItemType::name() const {
    if (kind == Kind::boolean) return "bool";
    const char letter = kind == Kind::floating ? 'f' : kind == Kind::signed_integer ? 'i' : 'u';
    return letter + std::to_string(8 * size) + (is_big_endian ? "be" : "");
}

std::optional<Format> ItemType::format() const {
    if (kind != Kind::floating) return {};
    return find_format(size == 2 ? "fp16" : size == 4 ? "f32" : "f64");
}

std::optional<ItemType> find_item_type(std::string_view word) {
    // Takes the byte order off the word: in front of it as numpy writes it, behind it otherwise.
    ItemType type;
    const bool is_numpy = !word.empty() && std::string_view("<>|=").find(word.front()) != std::string_view::npos;
    if (is_numpy) {
        type.is_big_endian = word.front() == '>';
        word.remove_prefix(1);
    } else if (word.ends_with("be") || word.ends_with("le")) {
        type.is_big_endian = word.ends_with("be");
        word.remove_suffix(2);
    }

    struct KnownType {
        std::string_view name, numpy;
        ItemType::Kind kind;
        std::uint8_t size;
    };
    using Kind = ItemType::Kind;
    static constexpr KnownType known_types[] = {
        {"f16", "f2", Kind::floating, 2},         {"f32", "f4", Kind::floating, 4},
        {"f64", "f8", Kind::floating, 8},         {"i8", "i1", Kind::signed_integer, 1},
        {"i16", "i2", Kind::signed_integer, 2},   {"i32", "i4", Kind::signed_integer, 4},
        {"i64", "i8", Kind::signed_integer, 8},   {"u8", "u1", Kind::unsigned_integer, 1},
        {"u16", "u2", Kind::unsigned_integer, 2}, {"u32", "u4", Kind::unsigned_integer, 4},
        {"u64", "u8", Kind::unsigned_integer, 8}, {"bool", "b1", Kind::boolean, 1},
    };

    for (const KnownType& known : known_types) {
        if (word != (is_numpy ? known.numpy : known.name) && !(known.kind == Kind::boolean && word == "?")) continue;
        type.kind = known.kind;
        type.size = known.size;
        return type;
    }
    return {};
}

}  // namespace lostbits::scene::ray_file
