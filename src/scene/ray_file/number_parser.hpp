// Reads numbers from text, and rounds each of them once to a format.
#pragma once

#include <string_view>

#include "number/format.hpp"

namespace lostbits::scene::ray_file {

/// Reads decimals, C hexadecimal floats, `nan` and `inf`, and rounds them to a format.
class NumberParser {
public:
    explicit NumberParser(const Format& format);

    enum class Kind { number, not_numeric, too_large };
    struct ParsedNumber {
        Kind kind = Kind::number;
        double value = 0;  ///< RN_F of the exact number in the text; NaN and infinities as written
        /// True if the text stands for a number of the format: it is exactly such a number, or it has no more digits
        /// than needed to distinguish the numbers of the format (9 in binary32, 17 in binary64).
        bool is_representable = true;
        /// Number of decimal digits from the first digit that is not 0. It is 0 if the text is exactly a number of the
        /// format and has fewer digits than needed to distinguish these numbers.
        int digits = 0;
    };
    [[nodiscard]] ParsedNumber read(std::string_view text) const;
    /// Number of digits that distinguish the numbers of the format.
    [[nodiscard]] int digits() const { return digits_; }

private:
    [[nodiscard]] ParsedNumber read_hexadecimal(std::string_view text) const;
    [[nodiscard]] ParsedNumber read_slowly(std::string_view text) const;

    Format format_;
    int digits_;  ///< number of digits that distinguish the numbers of the format
};

/// True if the double x is the value of a decimal that was written for a binary32 number: a decimal of nine digits, or
/// the shortest decimal.
bool is_float_in_decimal(double x);

}  // namespace lostbits::scene::ray_file
