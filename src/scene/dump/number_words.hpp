// Numbers written as text, each rounded once to a format.
#pragma once

#include <string_view>

#include "number/format.hpp"

namespace lostbits::scene::dump {

/// Reads decimals, C hexadecimal floats, `nan` and `inf`; what a format makes of them.
class NumberWords {
public:
    explicit NumberWords(const Format& format);

    enum class Kind { number, not_a_number_word, too_large };
    struct Word {
        Kind kind = Kind::number;
        double value = 0;  ///< RN_F of what is written, taken exactly; NaN and infinities where they are written
        /// Whether the format has the number that was meant: it is what is written, exactly, or what is written has no
        /// more digits than it takes to tell the numbers of the format apart (9 in binary32, 17 in binary64).
        bool held = true;
        /// Decimal digits from the first that is not 0, where they are not exactly a number of the format, or are as
        /// many as it needs; else 0.
        int digits = 0;
    };
    [[nodiscard]] Word read(std::string_view text) const;
    /// So many tell the numbers of the format apart.
    [[nodiscard]] int digits() const { return digits_; }

private:
    [[nodiscard]] Word read_hexadecimal(std::string_view text) const;
    [[nodiscard]] Word read_slowly(std::string_view text) const;

    Format format_;
    int digits_;  ///< that tell the numbers of the format apart
};

/// Whether a double is what a decimal of a binary32 number reads as: one of nine digits, or the shortest.
bool is_float_in_decimal(double x);

}  // namespace lostbits::scene::dump
