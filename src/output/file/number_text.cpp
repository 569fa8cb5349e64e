#include "output/file/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace lostbits::output::file {
namespace {

template <class F>
std::string shortest_text(F value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return std::signbit(value) ? "-inf" : "inf";
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

}  // namespace

std::string decimal(double value) { return shortest_text(value); }
std::string decimal(float value) { return shortest_text(value); }

std::string short_decimal(double value, int digits) {
    if (!std::isfinite(value)) return decimal(value);
    char text[400];
    const auto write = [&text](double x, auto... format) {
        return std::string(text, std::to_chars(text, text + sizeof text, x, format...).ptr);
    };

    // A negative zero is 0.
    const std::string scientific = write(value + 0.0, std::chars_format::scientific, digits - 1);
    const double rounded = parse_number(scientific).value_or(value), magnitude = std::fabs(rounded);
    if (magnitude == 0 || (magnitude >= 1e-4 && magnitude < std::pow(10, std::max(digits, 6))))
        return write(rounded, std::chars_format::fixed);

    // Very small and large numbers: a factor and a power of ten.
    const auto exponent_mark = scientific.find('e');
    const std::string power = "10^" + std::to_string(std::atoi(scientific.c_str() + exponent_mark + 1));
    std::string factor = scientific.substr(0, exponent_mark);
    if (factor.find('.') != std::string::npos) factor.erase(factor.find_last_not_of('0') + 1);
    if (factor.ends_with('.')) factor.pop_back();
    return factor == "1" ? power : factor == "-1" ? "-" + power : factor + "×" + power;
}

std::string kept_bits_text(double bits, int decimal_count) {
    if (!std::isfinite(bits)) return decimal(bits);
    char text[400];
    const double unit = std::pow(10, decimal_count), rounded_down = std::floor((bits + 1e-9) * unit) / unit;
    return {text, std::to_chars(text, text + sizeof text, rounded_down, std::chars_format::fixed, decimal_count).ptr};
}

std::string hex(double value) {
    if (!std::isfinite(value)) return shortest_text(value);
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, std::fabs(value), std::chars_format::hex).ptr;
    return (std::signbit(value) ? "-0x" : "0x") + std::string(text, end);
}

std::string word_list(const std::vector<std::string>& items) {
    std::string text;
    for (std::size_t k = 0; k < items.size(); ++k)
        text += (k == 0 ? "" : k + 1 == items.size() ? " and " : ", ") + items[k];
    return text;
}

std::optional<double> parse_number(std::string_view text) {
    const bool is_negative = text.starts_with('-');
    if (is_negative) text.remove_prefix(1);
    const bool is_hexadecimal = text.starts_with("0x");
    if (is_hexadecimal) text.remove_prefix(2);
    if (text.starts_with('-')) return std::nullopt;
    double x = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), x,
                                               is_hexadecimal ? std::chars_format::hex : std::chars_format::general);
    if (error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
    return is_negative ? -x : x;
}

double nearest_double(std::string_view digits, long exponent) {
    const std::string text = std::string(digits) + "e" + std::to_string(exponent);
    double x = 0;
    if (std::from_chars(text.data(), text.data() + text.size(), x).ec == std::errc{}) return x;
    const std::size_t zero_count = std::min(digits.find_first_not_of('0'), digits.size());
    const bool overflows = zero_count < digits.size() && static_cast<long>(digits.size() - zero_count) + exponent > 0;
    return overflows ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace lostbits::output::file
