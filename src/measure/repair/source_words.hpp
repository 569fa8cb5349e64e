// Expressions in the language of a user's function.
#pragma once

#include <string>
#include <string_view>

#include "intersect/function/function.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::repair {

/// How an operation is written: `$1:2` is the first operand, in brackets if it binds less tightly than 2. Choices bind
/// with -2, logic with -1, comparisons with 0, sums with 1, products with 2, signs with 3, calls with 4. A pattern
/// without text: the language has no such operation.
struct SourcePattern {
    std::string_view pattern;
    int binds;
};

/// `$f` is the f of `sqrtf`.
SourcePattern pattern_in(intersect::function::WrittenIn language, TapeOp op, bool is_double);

/// A conversion of the operand to float or double.
SourcePattern conversion_in(intersect::function::WrittenIn language, bool to_double);

/// The digits of a number of a format; empty if it is not finite.
std::string digits_in(intersect::function::WrittenIn language, double x, bool is_double);

/// `float name = ` or `let name = `, the begin of a declaration.
std::string declared_in(intersect::function::WrittenIn language, const std::string& name, bool is_double, bool decides);

}  // namespace lostbits::measure::repair
