// Properties of the operations of a tape, one struct for each operation. Name, kind and number of operands are in its
// row in number/tape.hpp. The kind decides the members of its struct; a missing one is a compile error.
//
//   given       exact(node) and rounding(node)
//   rounded     exact(a, …) without rounding; computed(a, …, format); residual(a, …, value): value − exact where
//               doubles can hold it; addends(a, …): what cancels; error_factors(a, …)
//   called      nothing: its value without rounding is in answer/without_rounding.hpp
//   exact       exact(a), computed(a, format), error_factors(a)
//   moved       computed(a, format): the next number up or down, or the nearest in another format
//   sign        computed(a, b, format), error_factors(a, b)
//   choice      sides: the indices of the two operands; takes_first(decider)
//   comparison  holds(decider)
//   logic       holds(decider)
//   all         text
//
// A decider compares operands: it answers less(i, j), less_equal(i, j) and holds(i) for the operands with those
// indices, by their computed or by their exact values.
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

/// Text in which `$1` is the first operand, and `$1:2` is the first operand in parentheses if its precedence is
/// below 2. It has no default, so an operation that lacks one of its texts does not compile.
struct Pattern {
    consteval Pattern(const char* pattern) : text(pattern) {}
    std::string_view text;
};

/// Precedence of an operation: 0 for decisions, 1 for sums, 2 for products, 3 for signs, 4 for calls.
struct Precedence {
    consteval Precedence(int number) : value(number) {}
    int value;
};

/// Texts of an operation. In C, `$f` is the f of `sqrtf` and empty for double, and `$t` is the type. In FPCore, `$e` is
/// the least positive number.
struct OperationText {
    Precedence precedence;
    Pattern plain;           ///< ASCII
    Pattern pretty = plain;  ///< with characters beyond ASCII
    /// Replaces `plain` in the generic style, if the operands differ in each round of a loop.
    std::string_view plain_in_loop = {};
    Pattern c;  ///< over float or double
    /// Formats that C lacks are computed in double. `c_wide` replaces `c` where the rounded double is not enough: it
    /// calls a function that rounds the exact result to the format. If C cannot do that, `missing_in_c` names what is
    /// missing.
    std::string_view c_wide = {}, missing_in_c = {};
    Pattern fpcore;
};

/// Fills a pattern: `$1:2` becomes `operand(0, 2)`, `$1` becomes `operand(0, 0)`, and `$f` becomes `word('f')`.
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

/// Error of an operand: the step from its exact value to its computed value. For a derivative both ends are the
/// computed value.
struct OperandError {
    double from = 0, to = 0;
    bool is_derivative = false;

    [[nodiscard]] double middle() const { return from / 2 + to / 2; }
    /// Difference quotient of the absolute value: (|to| − |from|)/(to − from).
    [[nodiscard]] double absolute_value_quotient() const {
        if (std::signbit(to) == std::signbit(from)) return std::signbit(to) ? -1 : 1;
        return (std::fabs(to) - std::fabs(from)) / (to - from);
    }
};

/// Factors by which the operands' errors are multiplied. Empty for decisions, for sides that are not chosen, and for
/// the operand of copysign that gives its sign.
using ErrorFactors = std::array<std::optional<double>, 3>;

/// One struct for each row of LOSTBITS_TAPE_OPERATIONS: operation_rows.hpp.
template <TapeOp op>
struct Operation;

}  // namespace lostbits::measure::attribution
