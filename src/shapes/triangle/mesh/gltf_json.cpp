#include "shapes/triangle/mesh/gltf_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <iterator>

namespace lostbits::scene::triangle {

namespace {

using intersect::process::StopToken;
using nlohmann::json;

constexpr int max_depth = 64;                   // a mesh needs nine
constexpr std::size_t max_values = 10'000'000;  // about 100 bytes of memory each

/// An iterator over the characters of a JSON. It records the furthest position that it has reached, and checks the stop
/// token.
class CharacterIterator {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    CharacterIterator(const char* position, StopToken stop, const char** furthest_position = nullptr)
        : position_(position), stop_(stop), furthest_position_(furthest_position) {}
    reference operator*() const { return *position_; }
    CharacterIterator& operator++() {
        constexpr std::uintptr_t stop_check_mask = 0xffff;
        if ((reinterpret_cast<std::uintptr_t>(++position_) & stop_check_mask) == 0) stop_.check();
        if (furthest_position_ != nullptr) *furthest_position_ = position_;
        return *this;
    }
    CharacterIterator operator++(int) {
        const CharacterIterator previous = *this;
        ++*this;
        return previous;
    }
    friend bool operator==(const CharacterIterator& a, const CharacterIterator& b) {
        return a.position_ == b.position_;
    }

private:
    const char* position_;
    StopToken stop_;
    const char** furthest_position_;
};

/// Returns `file:line:col` for a byte of a text, or `file: byte n` for a text that begins at byte `json_begin` of a
/// binary file.
std::string position_in(const std::string& file, std::string_view text, std::size_t byte, std::uint64_t json_begin) {
    if (json_begin > 0) return fmt::format("{}: byte {}", file, json_begin + byte);
    const std::string_view preceding = text.substr(0, byte);
    const std::size_t line_begin = preceding.rfind('\n') + 1;  // npos + 1 is 0
    const auto starts_character = [](char c) { return (c & 0xc0) != 0x80; };
    return fmt::format("{}:{}:{}", file, std::ranges::count(preceding, '\n') + 1,
                       std::ranges::count_if(preceding.substr(line_begin), starts_character) + 1);
}

/// Checks the limits of a JSON, the depth and the number of its values, before memory is allocated for it. (The
/// library's own callback would look at all elements of an array again after each element.)
class LimitChecker final : public nlohmann::json_sax<json> {
public:
    using Fail = std::function<void(const std::string&)>;
    explicit LimitChecker(Fail fail) : fail_(std::move(fail)) {}

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(number_integer_t) override { return count(); }
    bool number_unsigned(number_unsigned_t) override { return count(); }
    bool number_float(number_float_t, const string_t&) override { return count(); }
    bool string(string_t&) override { return count(); }
    bool binary(binary_t&) override { return count(); }
    bool key(string_t&) override { return true; }
    bool start_object(std::size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_array() override { return leave(); }
    bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
        // The message of the library is "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error
        // …". The part before the first colon is dropped, because `fail_` prints the position.
        const std::string_view message = error.what();
        const std::size_t colon = message.find(": ");
        fail_("is not JSON: " + std::string(colon < message.size() ? message.substr(colon + 2) : message));
        return false;
    }

private:
    bool count() {
        if (++values_ > max_values) fail_(fmt::format("has more than {} values; is it a mesh?", max_values));
        return true;
    }
    bool enter() {
        if (++depth_ > max_depth) fail_(fmt::format("is nested in more than {} values; is it a glTF?", max_depth));
        return count();
    }
    bool leave() {
        --depth_;
        return true;
    }

    Fail fail_;
    int depth_ = 0;
    std::size_t values_ = 0;
};

}  // namespace

json parse_gltf_json(const std::string& file, std::string_view text, std::uint64_t json_begin, StopToken stop) {
    const char* furthest_position = text.data();
    LimitChecker limit_checker([&](const std::string& message) {
        const auto bytes_read = static_cast<std::size_t>(furthest_position - text.data());
        throw InputError(position_in(file, text, bytes_read - (bytes_read > 0 ? 1 : 0), json_begin) + ": " + message);
    });
    // The parser takes a byte 0 for the end of the text. Zero bytes at the end are the padding of a binary file.
    if (const auto zero_position = text.find('\0');
        text.find_first_not_of('\0', std::min(zero_position, text.size())) < text.size())
        throw InputError(position_in(file, text, zero_position, json_begin) +
                         ": has a zero byte with more text after it; is it a text file?");
    const CharacterIterator first(text.data(), stop), last(text.data() + text.size(), stop);
    json::sax_parse(CharacterIterator(text.data(), stop, &furthest_position), last, &limit_checker);
    return json::parse(first, last);
}

std::optional<std::string> decode_base64(std::string_view letters, StopToken stop) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::int8_t, 256> values;
    values.fill(-1);
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);

    for (int padding = 0; padding < 2 && letters.ends_with('='); ++padding) letters.remove_suffix(1);
    if (letters.size() % 4 == 1) return std::nullopt;

    // Four letters of six bits make three bytes.
    std::string bytes;
    bytes.reserve(letters.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < letters.size(); ++i) {
        const std::int8_t value = values[static_cast<unsigned char>(letters[i])];
        if (value < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        if (i % 4 != 0) bytes += static_cast<char>(bits >> (6 - 2 * (i % 4)));
        if (i % 0x10000 == 0) stop.check();
    }
    return bytes;
}

std::optional<std::string> decode_uri(std::string_view uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name += uri[i];
            continue;
        }
        const std::string_view digits = uri.substr(i + 1, 2);
        unsigned byte = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
        if (digits.size() < 2 || error != std::errc() || end != digits.data() + 2) return std::nullopt;
        name += static_cast<char>(byte);
        i += 2;
    }
    return name;
}

}  // namespace lostbits::scene::triangle
