// Error of one operation of a tape: its own rounding, its cancellation, and the factors for errors of its operands.
#pragma once

#include <array>

#include "measure/attribution/operation.hpp"

namespace lostbits::measure::attribution {

/// The operand that a select, min or max chose; `no_node` for any other operation.
NodeId chosen_side(const Tape& tape, NodeId i);

/// True if a result can differ from the exact one on the same operands, by rounding or by a choice that rounding
/// changed.
bool can_err(TapeOp op);

/// True if the change of value is intended and not a rounding: a form moves to the next number on purpose.
constexpr bool is_on_purpose(TapeOp op) { return op == TapeOp::next_up || op == TapeOp::next_down; }

/// Returns computed − the exact operation on the computed operands, from error-free residuals. Accurate to a few units
/// in 2^-50 of itself, and zero if the operation was exact. Infinite if a finite result overflowed; zero if an operand
/// is already not finite.
double rounding_of(const Tape& tape, NodeId i);

/// Returns max(exponent of operands) − exponent of result, but at least 0, for a sum, a difference, or the sum in an
/// fma; p if the result is zero and an operand is not. Returns 0 for every other operation.
int cancellation(const Tape& tape, NodeId i);

/// The ulp of the format at x, of any sign: 2^(max(⌊log2|x|⌋, emin) − p + 1); the smallest for 0, infinity and NaN.
double ulp_at(double x, const FloatFormat& format);

/// Result of the operation on numbers of the format, correctly rounded to it. Not for inputs, calls, choices and
/// decisions.
double result_of(TapeOp op, const std::array<double, 3>& x, const FloatFormat& format);

/// Difference quotients of `OperationError`, or derivatives if the steps have no length. For a choice, which has no
/// quotient of its own, 1 for `chosen`, the side that it chose. Not for calls.
ErrorFactors error_factors_of(const TapeNode& node, const std::array<OperandError, 3>& x, NodeId chosen);

}  // namespace lostbits::measure::attribution
