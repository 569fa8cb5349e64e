// Writes expressions in the language of a user's function.
#pragma once

#include <string>
#include <string_view>

#include "intersect/function/function.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::repair {

/// Pattern of an operation: `$1:2` is the first operand, in parentheses if its precedence is below 2. Choices have
/// the precedence -2, logic -1, comparisons 0, sums 1, products 2, signs 3, calls 4. The pattern is
/// empty if the language has no such operation.
struct SourcePattern {
    std::string_view pattern;
    int precedence;
};

/// Pattern of an operation on floats or doubles.
SourcePattern pattern_in(intersect::function::FileLanguage language, TapeOp op, bool is_double);

/// Pattern of a conversion of the operand to float or double.
SourcePattern conversion_in(intersect::function::FileLanguage language, bool to_double);

/// Literal of a float or double; empty if the number is not finite.
std::string digits_in(intersect::function::FileLanguage language, double x, bool is_double);

/// Beginning of a declaration: `float name = ` or `let name = `.
std::string declaration_in(intersect::function::FileLanguage language, const std::string& name, bool is_double,
                           bool is_boolean);

}  // namespace lostbits::measure::repair
