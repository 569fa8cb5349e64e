// What is known of each operation of a tape, one struct an operation. Its name, its kind and the number of its operands
// are its row in number/tape.hpp; what its struct holds follows from the kind (below), and without it nothing compiles.
//
//   given       exact(node) and rounding(node)
//   rounded     exact(a, …) without rounding; computed(a, …, format); residual(a, …, value): value − exact where
//               doubles can hold it; addends(a, …): what cancels; quotients(a, …)
//   called      nothing: what it gives without rounding is in answer/self.hpp
//   exact       exact(a), computed(a, format), quotients(a)
//   moved       computed(a, format)
//   sign        computed(a, b, format), quotients(a, b)
//   choice      sides: the places of the two operands; takes_first(judge)
//   comparison  holds(judge)
//   logic       holds(judge)
//   all         text
//
// A judge answers less(i, j), less_equal(i, j) and holds(i) for the operands at those places, by their computed or by
// their exact values.
//
// And how an operation is written: patterns, and what puts operands into them.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "number/tape.hpp"

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

/// From the exact value of an operand to the computed one. Of a derivative both are the computed one.
struct Step {
    double from = 0, to = 0;
    bool is_derivative = false;

    [[nodiscard]] double middle() const { return from / 2 + to / 2; }
    /// (|to| − |from|)/(to − from)
    [[nodiscard]] double of_size() const {
        if (std::signbit(to) == std::signbit(from)) return std::signbit(to) ? -1 : 1;
        return (std::fabs(to) - std::fabs(from)) / (to - from);
    }
};

/// By how much each operand's error is multiplied on the way through; none for decisions, for sides not taken, and for
/// the operand of copysign that gives its sign.
using Quotients = std::array<std::optional<double>, 3>;

/// One struct for each row of LOSTBITS_TAPE_OPERATIONS: operation_rows.hpp.
template <TapeOp op>
struct Operation;

}  // namespace lostbits::measure::blame
