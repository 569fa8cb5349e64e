// All operations, one struct for each: inputs and constants; operations that compute a value (sums, products, roots,
// signs, moves); and those that decide (choices between two numbers, comparisons, logic).
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "measure/attribution/operation.hpp"
#include "number/error_free.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::attribution {

using Addends = std::optional<std::array<double, 2>>;

struct IsNotASum {
    static Addends addends(auto...) { return {}; }
};

/// Inputs and constants are written as their name or their digits.
struct GivenText {
    static constexpr OperationText text{.precedence = 4, .plain = "", .c = "", .fpcore = ""};
};

template <>
struct Operation<TapeOp::input> : GivenText {
    static auto exact(auto e, const TapeNode& node) { return e.lift(node.value); }
    static double rounding(const TapeNode&) { return 0; }
};

template <>
struct Operation<TapeOp::constant> : GivenText {
    static auto exact(auto e, const TapeNode& node) {
        return typename decltype(e)::Number(static_cast<int>(node.operands[0]));
    }
    static double rounding(const TapeNode& node) { return node.value - static_cast<double>(node.operands[0]); }
};

template <>
struct Operation<TapeOp::add> {
    static constexpr OperationText text{
        .precedence = 1, .plain = "$1:1 + $2:1", .c = "$1 + $2", .c_wide = "sum($1, $2)", .fpcore = "(+ $1 $2)"};
    static auto exact(auto e, const auto& a, const auto& b) { return e.sum(a, b); }
    static double computed(double a, double b, const FloatFormat& format) { return rounding::add(a, b, format); }
    static std::optional<double> residual(double a, double b, double value) {
        if (!(std::fabs(a) <= error_free_high && std::fabs(b) <= error_free_high)) return {};
        const auto [s, e] = two_sum(a, b);
        return (value - s) - e;
    }
    static Addends addends(double a, double b) { return {{a, b}}; }
    static ErrorFactors error_factors(const OperandError&, const OperandError&) { return {1, 1}; }
};

template <>
struct Operation<TapeOp::sub> {
    static constexpr OperationText text{.precedence = 1,
                                        .plain = "$1:1 - $2:2",
                                        .pretty = "$1:1 − $2:2",
                                        .c = "$1 - $2",
                                        .c_wide = "sum($1, -$2)",
                                        .fpcore = "(- $1 $2)"};
    static auto exact(auto e, const auto& a, const auto& b) { return e.sum(a, -b); }
    static double computed(double a, double b, const FloatFormat& format) { return rounding::add(a, -b, format); }
    static std::optional<double> residual(double a, double b, double value) {
        return Operation<TapeOp::add>::residual(a, -b, value);
    }
    static Addends addends(double a, double b) { return {{a, b}}; }
    static ErrorFactors error_factors(const OperandError&, const OperandError&) { return {1, -1}; }
};

template <>
struct Operation<TapeOp::mul> : IsNotASum {
    static constexpr OperationText text{.precedence = 2,
                                        .plain = "$1:2*$2:3",
                                        .pretty = "$1:2·$2:3",
                                        .c = "$1 * $2",
                                        .c_wide = "product($1, $2)",
                                        .fpcore = "(* $1 $2)"};
    static auto exact(auto, const auto& a, const auto& b) { return a * b; }
    static double computed(double a, double b, const FloatFormat& format) { return rounding::mul(a, b, format); }
    static std::optional<double> residual(double a, double b, double value) {
        if (a == 0 || b == 0) return 0;
        if (!residuals_are_exact(a * b)) return {};
        const auto [p, e] = two_product(a, b);
        return (value - p) - e;
    }
    static ErrorFactors error_factors(const OperandError& a, const OperandError& b) { return {b.middle(), a.middle()}; }
};

template <>
struct Operation<TapeOp::div> : IsNotASum {
    static constexpr OperationText text{
        .precedence = 2, .plain = "$1:2/$2:3", .c = "$1 / $2", .c_wide = "quotient($1, $2)", .fpcore = "(/ $1 $2)"};
    static auto exact(auto, const auto& a, const auto& b) { return a / b; }
    static double computed(double a, double b, const FloatFormat& format) { return rounding::div(a, b, format); }
    /// a/b = q + r/b with r = a − qb exact.
    static std::optional<double> residual(double a, double b, double value) {
        if (a == 0 || b == 0) return 0;
        const double q = a / b;
        if (!residuals_are_exact(a, b, q)) return {};
        return (value - q) - quotient_residual(a, b, q) / b;
    }
    static ErrorFactors error_factors(const OperandError& a, const OperandError& b) {
        return {(1 / b.from + 1 / b.to) / 2, -(a.from / b.from / b.to + a.to / b.from / b.to) / 2};
    }
};

template <>
struct Operation<TapeOp::sqrt> : IsNotASum {
    static constexpr OperationText text{
        .precedence = 4, .plain = "sqrt($1)", .c = "sqrt$f($1)", .c_wide = "root($1)", .fpcore = "(sqrt $1)"};
    static auto exact(auto, const auto& a) { return sqrt(a); }
    static double computed(double a, const FloatFormat& format) { return rounding::sqrt(a, format); }
    /// √a = s + r/(2s) to within (r/2s)²/2s, r = a − s².
    static std::optional<double> residual(double a, double value) {
        if (a <= 0) return 0;
        if (!residuals_are_exact(a)) return {};
        const double s = std::sqrt(a);
        return (value - s) - root_residual(a, s) / (2 * s);
    }
    /// An exact zero contributes no error; its derivative is infinite all the same.
    static ErrorFactors error_factors(const OperandError& a) {
        const double sum = std::sqrt(a.from) + std::sqrt(a.to);
        return {sum == 0 && !a.is_derivative ? 0 : 1 / sum};
    }
};

template <>
struct Operation<TapeOp::fma> {
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "fma($1, $2, $3)",
                                        .c = "fma$f($1, $2, $3)",
                                        .missing_in_c = "a fused multiply-add",
                                        .fpcore = "(fma $1 $2 $3)"};
    static auto exact(auto e, const auto& a, const auto& b, const auto& c) { return e.sum(a * b, c); }
    static double computed(double a, double b, double c, const FloatFormat& format) {
        return rounding::fma(a, b, c, format);
    }
    static std::optional<double> residual(double, double, double, double) { return {}; }
    static Addends addends(double a, double b, double c) { return {{a * b, c}}; }
    static ErrorFactors error_factors(const OperandError& a, const OperandError& b, const OperandError&) {
        return {b.middle(), a.middle(), 1};
    }
};

template <>
struct Operation<TapeOp::call> {
    /// The call sums without rounding. C has no function for that, so its text `$v` is the number that the call
    /// returned. FPCore has no operation for that either, so there is no text, and `explain --fpcore` refuses the ray.
    static constexpr OperationText text{.precedence = 4, .plain = "exactly(ray, primitive)", .c = "$v", .fpcore = ""};
};

template <>
struct Operation<TapeOp::neg> {
    static constexpr OperationText text{
        .precedence = 3, .plain = "-$1:3", .pretty = "−$1:3", .c = "-$1", .fpcore = "(- $1)"};
    static auto exact(auto, const auto& a) { return -a; }
    static double computed(double a, const FloatFormat&) { return -a; }
    static ErrorFactors error_factors(const OperandError&) { return {-1}; }
};

template <>
struct Operation<TapeOp::abs> {
    static constexpr OperationText text{.precedence = 4, .plain = "abs($1)", .c = "fabs$f($1)", .fpcore = "(fabs $1)"};
    static auto exact(auto, const auto& a) { return abs(a); }
    static double computed(double a, const FloatFormat&) { return std::fabs(a); }
    static ErrorFactors error_factors(const OperandError& a) { return {a.absolute_value_quotient()}; }
};

template <>
struct Operation<TapeOp::copysign> {
    static constexpr OperationText text{
        .precedence = 4, .plain = "copysign($1, $2)", .c = "copysign$f($1, $2)", .fpcore = "(copysign $1 $2)"};
    static double computed(double a, double b, const FloatFormat&) { return std::copysign(a, b); }
    static ErrorFactors error_factors(const OperandError& a, const OperandError& b) {
        return {std::signbit(b.to) ? -a.absolute_value_quotient() : a.absolute_value_quotient()};
    }
};

template <>
struct Operation<TapeOp::next_up> {
    /// FPCore has no next number. But x + η rounded upward, with η the least positive number of the format, is the next
    /// number above any finite x. −∞ stays what it is, and the number above −η is +0 in place of −0.
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "next_up($1)",
                                        .c = "nextafter$f($1, INFINITY)",
                                        .missing_in_c = "a move to the next number",
                                        .fpcore = "(! :round toPositive (+ $1 $e))"};
    static double computed(double a, const FloatFormat& format) { return rounding::next_up(a, format); }
};

template <>
struct Operation<TapeOp::next_down> {
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "next_down($1)",
                                        .c = "nextafter$f($1, -INFINITY)",
                                        .missing_in_c = "a move to the next number",
                                        .fpcore = "(! :round toNegative (- $1 $e))"};
    static double computed(double a, const FloatFormat& format) { return -rounding::next_up(-a, format); }
};

template <>
struct Operation<TapeOp::convert> {
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "convert($1)",
                                        .c = "($t)$1",
                                        .missing_in_c = "a change of format",
                                        .fpcore = "(cast $1)"};
    static double computed(double a, const FloatFormat& format) { return rounding::to_format(a, 0, format); }
};

template <>
struct Operation<TapeOp::min> {
    static constexpr OperationText text{
        .precedence = 4, .plain = "min($1, $2)", .c = "$1 < $2 ? $1 : $2", .fpcore = "(if (< $1 $2) $1 $2)"};
    static constexpr std::array<std::size_t, 2> sides{0, 1};
    static bool takes_first(const auto& decider) { return decider.less(0, 1); }
};

template <>
struct Operation<TapeOp::max> {
    static constexpr OperationText text{
        .precedence = 4, .plain = "max($1, $2)", .c = "$1 > $2 ? $1 : $2", .fpcore = "(if (> $1 $2) $1 $2)"};
    static constexpr std::array<std::size_t, 2> sides{0, 1};
    static bool takes_first(const auto& decider) { return decider.less(1, 0); }
};

template <>
struct Operation<TapeOp::select> {
    static constexpr OperationText text{.precedence = 4,
                                        .plain = "select($1, $2, $3)",
                                        .plain_in_loop = "a choice",
                                        .c = "$1 ? $2 : $3",
                                        .fpcore = "(if $1 $2 $3)"};
    static constexpr std::array<std::size_t, 2> sides{1, 2};
    static bool takes_first(const auto& decider) { return decider.holds(0); }
};

template <>
struct Operation<TapeOp::less> {
    static constexpr OperationText text{.precedence = 0, .plain = "$1:1 < $2:1", .c = "$1 < $2", .fpcore = "(< $1 $2)"};
    static bool holds(const auto& decider) { return decider.less(0, 1); }
};

template <>
struct Operation<TapeOp::less_equal> {
    static constexpr OperationText text{
        .precedence = 0, .plain = "$1:1 <= $2:1", .c = "$1 <= $2", .fpcore = "(<= $1 $2)"};
    static bool holds(const auto& decider) { return decider.less_equal(0, 1); }
};

template <>
struct Operation<TapeOp::greater> {
    static constexpr OperationText text{.precedence = 0, .plain = "$1:1 > $2:1", .c = "$1 > $2", .fpcore = "(> $1 $2)"};
    static bool holds(const auto& decider) { return decider.less(1, 0); }
};

template <>
struct Operation<TapeOp::greater_equal> {
    static constexpr OperationText text{
        .precedence = 0, .plain = "$1:1 >= $2:1", .c = "$1 >= $2", .fpcore = "(>= $1 $2)"};
    static bool holds(const auto& decider) { return decider.less_equal(1, 0); }
};

template <>
struct Operation<TapeOp::logical_and> {
    static constexpr OperationText text{
        .precedence = 0, .plain = "$1:1 and $2:1", .c = "$1 && $2", .fpcore = "(and $1 $2)"};
    static bool holds(const auto& decider) { return decider.holds(0) && decider.holds(1); }
};

template <>
struct Operation<TapeOp::logical_or> {
    static constexpr OperationText text{
        .precedence = 0, .plain = "$1:1 or $2:1", .c = "$1 || $2", .fpcore = "(or $1 $2)"};
    static bool holds(const auto& decider) { return decider.holds(0) || decider.holds(1); }
};

template <>
struct Operation<TapeOp::logical_not> {
    static constexpr OperationText text{.precedence = 0, .plain = "not $1:1", .c = "!$1", .fpcore = "(not $1)"};
    static bool holds(const auto& decider) { return !decider.holds(0); }
};

template <>
struct Operation<TapeOp::any> {
    static constexpr OperationText text{.precedence = 0, .plain = "any($1)", .c = "$1", .fpcore = "$1"};
    static bool holds(const auto& decider) { return decider.holds(0); }
};

}  // namespace lostbits::measure::attribution
