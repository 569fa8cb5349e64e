#include "scene/ray_file/number_parser.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "number/real.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::ray_file {

namespace {

using ParsedNumber = NumberParser::ParsedNumber;
using Kind = NumberParser::Kind;

std::string_view unsigned_part(std::string_view text) {
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
    return text;
}

bool is_word(std::string_view text, std::string_view lower_case) {
    if (text.size() != lower_case.size()) return false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (std::tolower(static_cast<unsigned char>(text[i])) != lower_case[i]) return false;
    }
    return true;
}

/// Counts the decimal digits from the first that is not zero to the last, before the exponent.
int significant_digits(std::string_view text) {
    int digits = 0;
    for (const char c : text) {
        if (c == 'e' || c == 'E') break;
        if (c >= '0' && c <= '9' && (digits > 0 || c != '0')) ++digits;
    }
    return digits;
}

/// True if a decimal of few digits is exactly `x`, the double nearest to it. n / 10^d either equals m / 2^d, or differs
/// from it by at least 10^-d.
bool is_exactly(std::string_view text, double x) {
    const std::size_t end = std::min(text.find_first_of("eE"), text.size()), point = text.find('.');
    int place_count = point < end ? static_cast<int>(end - point) - 1 : 0;
    if (end < text.size()) {
        std::string_view exponent = text.substr(end + 1);
        if (exponent.starts_with('+')) exponent.remove_prefix(1);
        int power = 0;
        std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
        place_count -= power;
    }
    const double scaled = std::ldexp(x, std::max(place_count, 0));
    return scaled == std::trunc(scaled);
}

template <class F>
bool parse_whole_text(std::string_view text, F& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

NumberParser::NumberParser(const Format& format)
    : format_(format), digits_(static_cast<int>(std::ceil(1 + format.parameters.precision * std::log10(2.0)))) {}

ParsedNumber NumberParser::read(std::string_view text) const {
    const std::string_view magnitude = unsigned_part(text);
    if (magnitude.empty()) return {Kind::not_numeric};

    // Words: NaN and infinities.
    const char first = magnitude.front();
    if (first == 'n' || first == 'N' || first == 'i' || first == 'I') {
        const double sign = text.front() == '-' ? -1 : 1;
        if (is_word(magnitude, "nan")) return {Kind::number, std::numeric_limits<double>::quiet_NaN()};
        if (is_word(magnitude, "inf") || is_word(magnitude, "infinity")) return {Kind::number, sign * HUGE_VAL};
        return {Kind::not_numeric};
    }

    const bool is_hexadecimal =
        magnitude.size() > 1 && magnitude[0] == '0' && (magnitude[1] == 'x' || magnitude[1] == 'X');
    if (is_hexadecimal) return read_hexadecimal(text);

    if (text.front() == '+') text.remove_prefix(1);

    // Both functions round correctly. Text that they do not read completely is read slowly, which finds the fault.
    if (format_.engine == Format::Engine::native32) {
        float narrow = 0;
        if (!parse_whole_text(text, narrow)) return read_slowly(text);
        ParsedNumber parsed{Kind::number, narrow};
        const int digits = significant_digits(magnitude);
        double wide = 0;
        if (digits < digits_) {
            const bool is_exact =
                digits < 2 || (parse_whole_text(text, wide) && wide == parsed.value && is_exactly(text, wide));
            parsed.digits = is_exact ? 0 : digits;
            return parsed;
        }
        parsed.digits = digits;
        parsed.is_representable = digits == digits_ || (parse_whole_text(text, wide) && wide == parsed.value);
        return parsed;
    }

    if (const int digits = significant_digits(magnitude);
        format_.engine == Format::Engine::native64 && digits <= digits_) {
        ParsedNumber parsed;
        if (parse_whole_text(text, parsed.value)) {
            parsed.digits = digits < digits_ && (digits < 2 || is_exactly(text, parsed.value)) ? 0 : digits;
            return parsed;
        }
    }
    return read_slowly(text);
}

ParsedNumber NumberParser::read_hexadecimal(std::string_view text) const {
    // A text of at most 53 bits is exactly a double, except for the smallest numbers.
    const std::string_view digits = unsigned_part(text).substr(2);
    double exact = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), exact, std::chars_format::hex);
    const bool is_short = digits.substr(0, digits.find_first_of("pP")).size() <= 14;
    const bool is_native = !format_.is_emulated();
    if (!is_native || !is_short || error != std::errc{} || end != digits.data() + digits.size() || !(exact > 0x1p-900))
        return read_slowly(text);
    if (text.front() == '-') exact = -exact;
    const double value = format_.engine == Format::Engine::native32 ? static_cast<float>(exact) : exact;
    if (std::isinf(value)) return {Kind::too_large};
    return {Kind::number, value, value == exact, digits_};
}

ParsedNumber NumberParser::read_slowly(std::string_view text) const {
    const auto exact_or_fault = toml::parse_number(text);
    if (const auto* const fault = std::get_if<toml::NumberFault>(&exact_or_fault))
        return {fault->is_too_large ? Kind::too_large : Kind::not_numeric};
    const Real& exact = std::get<Real>(exact_or_fault);
    ParsedNumber parsed{Kind::number, toml::round_to_format(exact, format_.parameters)};
    if (std::isinf(parsed.value)) return {Kind::too_large};
    const std::string_view magnitude = unsigned_part(text);
    const bool is_hexadecimal = magnitude.size() > 1 && (magnitude[1] == 'x' || magnitude[1] == 'X');
    const int digits = is_hexadecimal ? digits_ : significant_digits(magnitude);
    parsed.is_representable = exact == Real(parsed.value) || (!is_hexadecimal && digits <= digits_);
    parsed.digits = exact == Real(parsed.value) && digits < digits_ ? 0 : digits;
    return parsed;
}

bool is_float_in_decimal(double x) {
    const auto narrowed = static_cast<float>(x);
    char text[64];
    const auto reads_back = [&](std::to_chars_result written) {
        double value = 0;
        return parse_whole_text(std::string_view(text, static_cast<std::size_t>(written.ptr - text)), value) &&
               value == x;
    };
    return reads_back(std::to_chars(text, text + sizeof text, narrowed)) ||
           reads_back(std::to_chars(text, text + sizeof text, narrowed, std::chars_format::general, 9));
}

}  // namespace lostbits::scene::ray_file
