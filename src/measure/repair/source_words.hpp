// Writes expressions in the language of a user's function.
#pragma once

#include <string>
#include <string_view>

#include "intersect/function/function.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::repair {

/// How tightly an expression binds. Patterns contain the numbers; `:5` puts every expression but a name in parentheses.
enum class SourcePrecedence : int { choice = -2, logic = -1, comparison = 0, sum = 1, product = 2, sign = 3, call = 4 };

/// Pattern of an operation: `$1:2` is the first operand, in parentheses if its precedence is below 2. The pattern is
/// empty if the language has no such operation.
struct SourcePattern {
    std::string_view pattern;
    SourcePrecedence precedence;
};

/// Pattern of an operation on floats or doubles.
SourcePattern operation_pattern(intersect::function::FileLanguage language, TapeOp op, bool is_double);

/// Pattern of a conversion of the operand to float or double.
SourcePattern conversion_in(intersect::function::FileLanguage language, bool to_double);

/// Literal of a float or double; empty if the number is not finite.
std::string literal_in(intersect::function::FileLanguage language, double x, bool is_double);

/// Beginning of a declaration: `float name = ` or `let name = `.
std::string declaration_in(intersect::function::FileLanguage language, const std::string& name, bool is_double,
                           bool is_boolean);

}  // namespace lostbits::measure::repair
