// Reads numbers as people write them, into the ideal numbers of a scene.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "number/real.hpp"

namespace lostbits::scene::toml {

/// The reason why a text is not a number, as the end of a sentence with advice: `is not a number; …`.
struct NumberFault {
    std::string why;
    bool is_too_large = false;  ///< true if the text is a number above the largest binary64
};

/// Reads a decimal (`4100`, `-0.1`, `1e-3`) or a hexadecimal float (`0x1.004p+12`; the exponent is optional).
///
/// The text is taken exactly and rounded *once*, to the width of `Real` and to odd: an inexact result ends in a set
/// bit. Rounding the result again, to any format of at most 53 bits, then gives the same number as rounding the text
/// itself (Boldo and Melquiond, 2008), however many digits the text has. If the first rounding were to nearest, this
/// would not hold close to the middle of two neighbours.
///
/// Infinities, NaN and magnitudes above the largest binary64 are faults. Tiny numbers do not become zero.
std::variant<Real, NumberFault> parse_number(std::string_view text);

/// The exact value as a hexadecimal float that `parse_number` reads back to the same number: `0x1.5p+10`.
std::string exact_text(const Real& x);

}  // namespace lostbits::scene::toml
