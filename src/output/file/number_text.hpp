// Writes numbers as text that reads back to the same bits, and numbers or words as lists.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::output::file {

/// The shortest decimal that reads back to the same double; `nan` for any NaN, `inf`, `-inf`. `-0` keeps its sign.
[[nodiscard]] std::string decimal(double value);

/// The shortest decimal that reads back to the same float: `0.1`, not `0.10000000149011612`.
[[nodiscard]] std::string decimal(float value);

/// The value rounded to `digits` significant digits, for a reader: `0.5`, `12900`, `2.78×10^-6`, `10^9`. Powers of ten
/// begin below 10^-4 and at 10^6, or where the digits end. `nan`, `inf`, `-inf` as in `decimal`.
[[nodiscard]] std::string short_decimal(double value, int digits);

/// Bits that are kept, rounded down, so that the text does not claim more than was measured: `21.9` for 21.97. A
/// shortfall of 1e-9 counts as the rounding of a subtraction.
[[nodiscard]] std::string kept_bits_text(double bits, int decimal_count = 1);

/// The exact value as a C hexadecimal float: `0x1.8p+1`, `-0x0p+0`; `nan`, `inf`, `-inf`. A float converts to
/// double exactly, so one function serves both.
[[nodiscard]] std::string hex(double value);

/// A list of numbers, each written by `text`, separated by `between`.
template <class Numbers>
[[nodiscard]] std::string number_list(const Numbers& numbers, std::string (*text)(double), std::string_view separator) {
    std::string list;
    for (const double x : numbers) (list += list.empty() ? "" : separator) += text(x);
    return list;
}

/// A list of words: `a, b and c`.
[[nodiscard]] std::string word_list(const std::vector<std::string>& items);

/// Reads a number that `decimal` or `hex` wrote, in every locale. Returns nothing for any other text, and for a number
/// outside the range of a double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// The double nearest to digits · 10^exponent; 0 or infinity outside its range.
[[nodiscard]] double nearest_double(std::string_view digits, long exponent);

}  // namespace lostbits::output::file
