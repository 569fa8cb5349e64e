// Properties of the operations of a tape, one struct for each operation. Name, kind and number of operands are in its
// row in number/tape.hpp. The kind decides the members of its struct; a missing one is a compile error.
//
//   given       exact(node) and rounding(node)
//   rounded     exact(a, …) without rounding; computed(a, …, format); residual(a, …, value): value − exact where
//               doubles can hold it; addends(a, …): what cancels; quotients(a, …)
//   called      nothing: its value without rounding is in answer/without_rounding.hpp
//   exact       exact(a), computed(a, format), quotients(a)
//   moved       computed(a, format)
//   sign        computed(a, b, format), quotients(a, b)
//   choice      sides: the indices of the two operands; takes_first(judge)
//   comparison  holds(judge)
//   logic       holds(judge)
//   all         text
//
// A judge answers less(i, j), less_equal(i, j) and holds(i) for the operands with those indices, by their computed or
// by their exact values.
//
// The text of an operation is a set of patterns, in which `fill_pattern` replaces the placeholders by the operands.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Text in which `$1` is the first operand, and `$1:2` the same in brackets if it binds less tightly than 2. It has no
/// default, so an operation that lacks one of its texts does not compile.
struct Pattern {
    consteval Pattern(const char* pattern) : text(pattern) {}
    std::string_view text;
};

/// How tightly an operation binds: decisions 0, sums 1, products 2, signs 3, calls 4.
struct Binding {
    consteval Binding(int tightness) : level(tightness) {}
    int level;
};

/// Texts of an operation. In C, `$f` is the f of `sqrtf` and empty for double, and `$t` is the type. In FPCore, `$e` is
/// the least positive number.
struct OperationText {
    Binding binds;
    Pattern plain;                  ///< ASCII
    Pattern pretty = plain;         ///< with characters beyond ASCII
    std::string_view generic = {};  ///< replaces `plain` if each round of a loop computes it from something else
    Pattern c;                      ///< over float or double
    /// `c_wide`: text over double for a format that C lacks; it rounds the exact result to the format where the rounded
    /// double is not enough. `c_lacks`: if C cannot do that either, the name of what is missing.
    std::string_view c_wide = {}, c_lacks = {};
    Pattern fpcore;
};

/// Returns the pattern with `operand(k, binds)` in place of operands, k from 0, and `word(letter)` in place of letters.
template <class Operand, class Word>
std::string fill_pattern(std::string_view pattern, const Operand& operand, const Word& word) {
    const auto digit_at = [pattern](std::size_t i) { return pattern.at(i) - '0'; };
    std::string text;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (pattern[i] != '$') {
            text += pattern[i];
        } else if (const int k = digit_at(++i); k < 1 || k > 3) {
            text += word(pattern[i]);
        } else {
            const bool has_level = i + 1 < pattern.size() && pattern[i + 1] == ':';
            if (has_level) i += 2;
            text += operand(static_cast<std::size_t>(k - 1), has_level ? digit_at(i) : 0);
        }
    }
    return text;
}

template <class Operand>
std::string fill_pattern(std::string_view pattern, const Operand& operand) {
    return fill_pattern(pattern, operand,
                        [](char) -> std::string { throw std::logic_error("this pattern has no letters"); });
}

/// Step from the exact value of an operand to the computed value. For a derivative both ends are the computed value.
struct Step {
    double from = 0, to = 0;
    bool is_derivative = false;

    [[nodiscard]] double middle() const { return from / 2 + to / 2; }
    /// Difference quotient of the absolute value: (|to| − |from|)/(to − from).
    [[nodiscard]] double size_quotient() const {
        if (std::signbit(to) == std::signbit(from)) return std::signbit(to) ? -1 : 1;
        return (std::fabs(to) - std::fabs(from)) / (to - from);
    }
};

/// Factors by which the operands' errors are multiplied. Empty for decisions, for sides that are not chosen, and for
/// the operand of copysign that gives its sign.
using Quotients = std::array<std::optional<double>, 3>;

/// One struct for each row of LOSTBITS_TAPE_OPERATIONS: operation_rows.hpp.
template <TapeOp op>
struct Operation;

}  // namespace lostbits::measure::attribution
