// How an operation is written: patterns, and what puts operands into them.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace lostbits::measure::blame {

/// A text in which `$1` is the first operand and `$1:2` the same in brackets where it binds less tightly than 2. It has
/// no default, so that an operation without one of its texts does not compile.
struct Pattern {
    consteval Pattern(const char* written) : text(written) {}
    std::string_view text;
};

/// How tightly an operation binds: decisions 0, sums 1, products 2, signs 3, calls 4.
struct Binding {
    consteval Binding(int how_tightly) : level(how_tightly) {}
    int level;
};

/// In C, `$f` is the f of `sqrtf` and nothing for double, `$t` the type; in FPCore, `$e` is the least positive number.
struct OperationText {
    Binding binds;
    Pattern plain;                  ///< ASCII
    Pattern pretty = plain;         ///< with signs beyond ASCII
    Pattern latex = plain;          ///< in math mode
    std::string_view generic = {};  ///< in place of `plain` where each round of a loop computes it from something else
    Pattern c;                      ///< over float or double
    /// Over double, for a format that C has not: how the exact result is rounded to it where the rounded double alone
    /// would not do; or, where C has no way, what it is that cannot be had.
    std::string_view c_wide = {}, c_lacks = {};
    Pattern fpcore;
};

/// The pattern with `operand(k, binds)` for the places of operands, k from 0, and `word(letter)` for those of letters.
template <class Operand, class Word>
std::string filled(std::string_view pattern, const Operand& operand, const Word& word) {
    const auto digit_at = [pattern](std::size_t i) { return pattern.at(i) - '0'; };
    std::string text;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (pattern[i] != '$') {
            text += pattern[i];
        } else if (const int k = digit_at(++i); k < 1 || k > 3) {
            text += word(pattern[i]);
        } else {
            const bool says = i + 1 < pattern.size() && pattern[i + 1] == ':';
            if (says) i += 2;
            text += operand(static_cast<std::size_t>(k - 1), says ? digit_at(i) : 0);
        }
    }
    return text;
}

template <class Operand>
std::string filled(std::string_view pattern, const Operand& operand) {
    return filled(pattern, operand, [](char) -> std::string { throw std::logic_error("a text knows no letters"); });
}

}  // namespace lostbits::measure::blame
