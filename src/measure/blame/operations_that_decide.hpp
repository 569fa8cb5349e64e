// The operations that decide: choices between two numbers, comparisons, and what is made of decisions.
#pragma once

#include "measure/blame/operation.hpp"

namespace lostbits::measure::blame {

template <>
struct Operation<TapeOp::min> {
    static constexpr OperationText text{.binds = 4,
                                        .plain = "min($1, $2)",
                                        .latex = "\\operatorname{min}($1, $2)",
                                        .c = "$1 < $2 ? $1 : $2",
                                        .fpcore = "(if (< $1 $2) $1 $2)"};
    static constexpr std::array<std::size_t, 2> sides{0, 1};
    static bool takes_first(const auto& judge) { return judge.less(0, 1); }
};

template <>
struct Operation<TapeOp::max> {
    static constexpr OperationText text{.binds = 4,
                                        .plain = "max($1, $2)",
                                        .latex = "\\operatorname{max}($1, $2)",
                                        .c = "$1 > $2 ? $1 : $2",
                                        .fpcore = "(if (> $1 $2) $1 $2)"};
    static constexpr std::array<std::size_t, 2> sides{0, 1};
    static bool takes_first(const auto& judge) { return judge.less(1, 0); }
};

template <>
struct Operation<TapeOp::select> {
    static constexpr OperationText text{.binds = 4,
                                        .plain = "select($1, $2, $3)",
                                        .latex = "\\begin{cases} $2 & $1 \\\\ $3 & \\text{otherwise} \\end{cases}",
                                        .generic = "a choice",
                                        .c = "$1 ? $2 : $3",
                                        .fpcore = "(if $1 $2 $3)"};
    static constexpr std::array<std::size_t, 2> sides{1, 2};
    static bool takes_first(const auto& judge) { return judge.holds(0); }
};

template <>
struct Operation<TapeOp::less> {
    static constexpr OperationText text{.binds = 0, .plain = "$1:1 < $2:1", .c = "$1 < $2", .fpcore = "(< $1 $2)"};
    static bool holds(const auto& judge) { return judge.less(0, 1); }
};

template <>
struct Operation<TapeOp::less_equal> {
    static constexpr OperationText text{
        .binds = 0, .plain = "$1:1 <= $2:1", .latex = "$1:1 \\le $2:1", .c = "$1 <= $2", .fpcore = "(<= $1 $2)"};
    static bool holds(const auto& judge) { return judge.less_equal(0, 1); }
};

template <>
struct Operation<TapeOp::greater> {
    static constexpr OperationText text{.binds = 0, .plain = "$1:1 > $2:1", .c = "$1 > $2", .fpcore = "(> $1 $2)"};
    static bool holds(const auto& judge) { return judge.less(1, 0); }
};

template <>
struct Operation<TapeOp::greater_equal> {
    static constexpr OperationText text{
        .binds = 0, .plain = "$1:1 >= $2:1", .latex = "$1:1 \\ge $2:1", .c = "$1 >= $2", .fpcore = "(>= $1 $2)"};
    static bool holds(const auto& judge) { return judge.less_equal(1, 0); }
};

template <>
struct Operation<TapeOp::both> {
    static constexpr OperationText text{
        .binds = 0, .plain = "$1:1 and $2:1", .latex = "$1:1 \\land $2:1", .c = "$1 && $2", .fpcore = "(and $1 $2)"};
    static bool holds(const auto& judge) { return judge.holds(0) && judge.holds(1); }
};

template <>
struct Operation<TapeOp::either> {
    static constexpr OperationText text{
        .binds = 0, .plain = "$1:1 or $2:1", .latex = "$1:1 \\lor $2:1", .c = "$1 || $2", .fpcore = "(or $1 $2)"};
    static bool holds(const auto& judge) { return judge.holds(0) || judge.holds(1); }
};

template <>
struct Operation<TapeOp::opposite> {
    static constexpr OperationText text{
        .binds = 0, .plain = "not $1:1", .latex = "\\lnot $1:1", .c = "!$1", .fpcore = "(not $1)"};
    static bool holds(const auto& judge) { return !judge.holds(0); }
};

template <>
struct Operation<TapeOp::any> {
    static constexpr OperationText text{.binds = 0, .plain = "any($1)", .c = "$1", .fpcore = "$1"};
    static bool holds(const auto& judge) { return judge.holds(0); }
};

}  // namespace lostbits::measure::blame
