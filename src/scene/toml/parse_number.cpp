#include "scene/toml/parse_number.hpp"

#include <limits>

#include <mpfr.h>

namespace lostbits::scene::toml {
namespace {

constexpr const char* number_advice =
    R"(; write a decimal such as 4100 or "1e-3", or a hexadecimal float such as "0x1.004p+12")";

bool is_decimal(char c) { return c >= '0' && c <= '9'; }
bool is_hexadecimal(char c) { return is_decimal(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

std::size_t skip(std::string_view& text, bool (*is_wanted)(char)) {
    std::size_t n = 0;
    while (n < text.size() && is_wanted(text[n])) ++n;
    text.remove_prefix(n);
    return n;
}

bool skip_any_of(std::string_view& text, std::string_view characters) {
    if (text.empty() || characters.find(text.front()) == std::string_view::npos) return false;
    text.remove_prefix(1);
    return true;
}

/// sign? digits* ('.' digits*)? (exponent sign? decimal+)?, at least one digit before the exponent. MPFR alone would
/// also accept a prefix of the text, blanks, `@` exponents and names of infinity.
bool is_well_formed(std::string_view text, bool hexadecimal) {
    skip_any_of(text, "+-");
    if (hexadecimal) text.remove_prefix(2);
    const auto digit = hexadecimal ? is_hexadecimal : is_decimal;
    std::size_t digits = skip(text, digit);
    if (skip_any_of(text, ".")) digits += skip(text, digit);
    if (digits == 0) return false;
    if (skip_any_of(text, hexadecimal ? "pP" : "eE")) {
        skip_any_of(text, "+-");
        if (skip(text, is_decimal) == 0) return false;
    }
    return text.empty();
}

std::string_view unsigned_part(std::string_view text) {
    skip_any_of(text, "+-");
    return text;
}

bool is_infinity_or_nan(std::string_view text) {
    std::string lower_case;
    for (const char c : unsigned_part(text)) lower_case += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return lower_case == "inf" || lower_case == "infinity" || lower_case == "nan";
}

}  // namespace

std::variant<Real, NumberFault> parse_number(std::string_view text) {
    if (is_infinity_or_nan(text)) return NumberFault{std::string("is not finite") + number_advice};
    const std::string_view magnitude = unsigned_part(text);
    const bool hexadecimal = magnitude.starts_with("0x") || magnitude.starts_with("0X");
    if (!is_well_formed(text, hexadecimal)) return NumberFault{std::string("is not a number") + number_advice};

    Real x;
    mpfr_ptr raw = x.backend().data();
    const int inexact = mpfr_strtofr(raw, std::string(text).c_str(), nullptr, hexadecimal ? 16 : 10, MPFR_RNDZ);
    const bool last_bit_is_clear = mpfr_min_prec(raw) < mpfr_get_prec(raw);
    if (inexact != 0 && last_bit_is_clear) {
        if (mpfr_signbit(raw) != 0) mpfr_nextbelow(raw);
        else mpfr_nextabove(raw);
    }
    if (mpfr_cmpabs(raw, Real(std::numeric_limits<double>::max()).backend().data()) > 0)
        return NumberFault{"is larger than the largest binary64, about 1.8e308; write a smaller number", true};
    return x;
}

std::string exact_text(const Real& x) {
    // MPFR's own %Ra starts with any digit: 0x5.4p+8 for 1344, where C's %a writes 0x1.5p+10.
    const mpfr_srcptr raw = x.backend().data();
    const bool is_regular = mpfr_regular_p(raw) != 0;
    const mpfr_exp_t exponent = is_regular ? mpfr_get_exp(raw) - 1 : 0;
    Real scaled;  // 1 ≤ |scaled| < 2
    mpfr_mul_2si(scaled.backend().data(), raw, -exponent, MPFR_RNDN);
    char* text = nullptr;
    const int length = mpfr_asprintf(&text, "%Ra", scaled.backend().data());
    std::string result(text, static_cast<std::size_t>(length));
    mpfr_free_str(text);
    if (!is_regular) return result;
    return result.substr(0, result.find('p')) + (exponent < 0 ? "p" : "p+") + std::to_string(exponent);
}

}  // namespace lostbits::scene::toml
