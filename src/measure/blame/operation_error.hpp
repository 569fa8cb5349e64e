// One operation of a tape: its own rounding, its cancellation, and how errors of its operands go through it.
#pragma once

#include <array>

#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// The operand that a select, min or max took; none for any other operation.
NodeId chosen(const Tape& tape, NodeId i);
/// The side that a select, min or max names first.
NodeId first_side(const TapeNode& n);
NodeId other_side(const TapeNode& n, NodeId side);

/// computed − the exact operation on the operands as computed, from error-free residuals: good to a few units in 2^-50
/// of itself, and zero where the operation was exact. Infinite where a finite result overflowed; zero where an operand
/// already was no finite number.
double rounding_of(const Tape& tape, NodeId i);

/// max(exponent of operands) − exponent of result of a sum or a difference, or of the sum in an fma; p where the result
/// is zero and an operand is not; otherwise 0, and 0 for every other operation.
int cancellation(const Tape& tape, NodeId i);

/// The ulp of the format at x, of any sign: 2^(max(⌊log2|x|⌋, emin) − p + 1); the smallest for 0, infinity and NaN.
double ulp_at(double x, const FloatFormat& format);

/// The operation on numbers of the format, correctly rounded to it.
double apply(TapeOp op, const std::array<double, 3>& x, const FloatFormat& format);

struct Operand {
    double computed = 0, exact = 0;
};

/// By how much each operand's error is multiplied on the way through; `follows` is false for decisions, for sides not
/// taken, and for the operand of copysign that gives its sign.
struct Weights {
    std::array<double, 3> by{};
    std::array<bool, 3> follows{};
};

/// The difference quotients of `OperationError`, or, where `slopes`, the derivatives at the computed operands.
Weights quotients(const TapeNode& n, const std::array<Operand, 3>& x, NodeId chosen, bool slopes);

}  // namespace lostbits::measure::blame
