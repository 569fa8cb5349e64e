// One operation of a tape: its own rounding, its cancellation, and how errors of its operands go through it.
#pragma once

#include <array>

#include "measure/blame/operation.hpp"

namespace lostbits::measure::blame {

/// The operand that a select, min or max took; none for any other operation.
NodeId side_taken(const Tape& tape, NodeId i);

/// Whether a result can differ from the exact one on the same operands, by rounding or by a choice that rounding
/// turned.
bool can_err(TapeOp op);

/// Says if the operation adds no rounding: a form goes to the next number on purpose.
constexpr bool is_on_purpose(TapeOp op) { return op == TapeOp::next_up || op == TapeOp::next_down; }

/// computed − the exact operation on the operands as computed, from error-free residuals: good to a few units in 2^-50
/// of itself, and zero where the operation was exact. Infinite where a finite result overflowed; zero where an operand
/// already was no finite number.
double rounding_of(const Tape& tape, NodeId i);

/// max(exponent of operands) − exponent of result of a sum or a difference, or of the sum in an fma; p where the result
/// is zero and an operand is not; otherwise 0, and 0 for every other operation.
int cancellation(const Tape& tape, NodeId i);

/// The ulp of the format at x, of any sign: 2^(max(⌊log2|x|⌋, emin) − p + 1); the smallest for 0, infinity and NaN.
double ulp_at(double x, const FloatFormat& format);

/// What the operation gives for numbers of the format, correctly rounded to it. Not of inputs, calls, choices and
/// decisions.
double result_of(TapeOp op, const std::array<double, 3>& x, const FloatFormat& format);

/// The difference quotients of `OperationError`, or the derivatives where the steps are none. Of a choice, which has
/// none by itself, 1 for the side that it took. Not of calls.
Quotients quotients_of(const TapeNode& n, const std::array<Step, 3>& x, NodeId taken);

}  // namespace lostbits::measure::blame
