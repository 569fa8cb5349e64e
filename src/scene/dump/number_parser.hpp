// Numbers written as text, each rounded once to a format.
#pragma once

#include <string_view>

#include "number/format.hpp"

namespace lostbits::scene::dump {

/// Reads decimals, C hexadecimal floats, `nan` and `inf`, and rounds them to a format.
class NumberParser {
public:
    explicit NumberParser(const Format& format);

    enum class Kind { number, not_numeric, too_large };
    struct Parsed {
        Kind kind = Kind::number;
        double value = 0;  ///< RN_F of the exact number in the text; NaN and infinities as written
        /// True if the format has the number that was meant: the text is exactly a number of the format, or has no
        /// more digits than needed to distinguish the numbers of the format (9 in binary32, 17 in binary64).
        bool representable = true;
        /// Number of decimal digits from the first that is not 0, if they are not exactly a number of the format, or
        /// are as many as it needs; else 0.
        int digits = 0;
    };
    [[nodiscard]] Parsed read(std::string_view text) const;
    /// Number of digits that distinguish the numbers of the format.
    [[nodiscard]] int digits() const { return digits_; }

private:
    [[nodiscard]] Parsed read_hexadecimal(std::string_view text) const;
    [[nodiscard]] Parsed read_slowly(std::string_view text) const;

    Format format_;
    int digits_;  ///< number of digits that distinguish the numbers of the format
};

/// True if a double is what a decimal of a binary32 number reads as: one with nine digits, or the shortest.
bool is_float_in_decimal(double x);

}  // namespace lostbits::scene::dump
