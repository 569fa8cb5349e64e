// Attributes the error of an answer to the operations on its tape.
//
// The contribution of an operation is its own rounding error times the adjoint of the recorded path (Linnainmaa 1976,
// here with difference quotients). This is a rule, not a cause. Herbgrind (2018) blames by local error instead, and the
// values of Shapley and of Aumann and Shapley divide the error without choosing one path. rerun.hpp finds the effect of
// one operation by itself.
#pragma once

#include <optional>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Error of one node of a tape. `exact` is its value without any rounding, with every decision made by exact values.
///
/// An error passes through v = f(x) multiplied by the difference quotient between the computed (^) and the exact (*)
/// operands. For ab: (b^ + b*)/2 and (a^ + a*)/2; for a/b: (1/b^ + 1/b*)/2 and −(a^ + a*)/(2 b^ b*); for √a: 1/(√a^ +
/// √a*); for a sum: 1. To first order this is the derivative. Unlike the derivative it leaves no remainder, so the
/// contributions sum to the error even where the derivative is infinite (the root of a discriminant that rounds to 0).
struct OperationError {
    double exact = 0;       ///< rounded to the nearest double
    double error = 0;       ///< computed − exact
    double rounding = 0;    ///< its own error: computed − the exact operation on the computed operands; for a choice
                            ///< that rounding changed, exact value of the chosen side − exact value of the other side
    double adjoint = 0;     ///< difference quotient of the subject by this value
    double derivative = 0;  ///< ∂subject/∂value at the computed values; only with `AttributionDepth::full`
    double contribution = 0;  ///< rounding · adjoint, in the unit of the subject
    double local_bits = 0;    ///< bits that it loses when rerun on exact operands, each correctly rounded; only with
                              ///< `AttributionDepth::full`
    int cancelled_bits = 0;  ///< for a sum (or the sum in an fma), max(exponent of operands) − exponent of result; the
                             ///< whole significand if the result is 0
    /// For a choice, the operand that the result comes from. If both operands have the same computed value, it is the
    /// one that exact values choose, and the choice makes no error.
    NodeId chosen_side = no_node;
    bool operands_have_error = false;  ///< if true, a cancellation here is catastrophic, otherwise benign
    bool is_live = false;              ///< the subject is computed from it, through the chosen side of each choice
    bool decision_changed = false;  ///< rounding changed this decision, or the choice of this min, max, select or sign
};

struct Attribution {
    std::vector<OperationError> errors;  ///< one for each node
    NodeId subject = no_node;            ///< explained value: t, or the comparison that changed the decision
    bool is_exact_hit = false;           ///< the form's decision without rounding
    bool loop_was_cut_short = false;  ///< without rounding, a loop would have gone on; the exact values end where the
                                      ///< computed ones did
    double error = 0;                 ///< of the subject; for a comparison, of the difference of its sides
    double contribution_sum = 0;      ///< sum of the contributions
    double first_order_sum = 0;       ///< sum of the contributions by derivatives; only with `AttributionDepth::full`
    int exact_bits = 0;               ///< precision of the exact values: 106 (double-double with bounds), or 2048
    /// The live operation with the largest |contribution|. Among equals, the one that `find_largest_contributions` puts
    /// first: if one is computed from the other, the later one. If the subject (or a side of it) is not finite, the
    /// operation that made it so. None if there is no error.
    NodeId culprit = no_node;
    /// The other live operations that contribute as much as the culprit, with the same sign or the opposite one.
    std::vector<NodeId> equal_culprits;

    [[nodiscard]] const OperationError& operator[](NodeId i) const { return errors[i]; }
};

struct AttributionDepth {
    /// Finds the derivative and the local error of each operation too; exact values then have 2048 bits.
    bool full = false;
};

/// Attributes the error of a subject that is a number. For a decision, the subject is the difference of the sides of
/// the first comparison behind it that rounding changed; `no_node` if rounding changed no comparison.
///
/// Exact values are double-double with certified bounds if those settle every decision and bound each live value to
/// 2^-60 of the larger of it and the computed one. Otherwise they have 2048 bits, and values that differ by less than
/// 2^-1900 of themselves are equal.
Attribution attribute(const Tape& tape, NodeId subject, AttributionDepth depth = {});

/// Attributes the error of a tape's t if the form decides as it would without rounding; otherwise the error of the
/// decision. The t of a miss is not an answer, so no operation is its culprit.
Attribution attribute(const Tape& tape, AttributionDepth depth = {});

/// True if the form misses with and without rounding.
bool is_plain_miss(const Tape& tape, const Attribution& attribution);

/// Relative tolerance for equal contributions: two contributions are equal if their magnitudes agree to this part of
/// the larger. They are sums of products in binary64, which are far more accurate than the tolerance. But two
/// contributions that are equal to first order differ by the relative error of the operations between them, which from
/// binary32 up is mostly less than the tolerance. Measured on 2.9 million rays of the scenes: 11 % have equal
/// contributions, and on one in eight of those rays they differ by more than 2^-40.
inline constexpr double equal_contribution_tolerance = 0x1p-20;

/// The live operations with the largest |contribution|, the culprit first; none if there is no error. Those nearer to
/// the subject come first. The distance is the largest number of operations in between, so an operation comes before
/// those that it is computed from. Equally near ones are in the order of the formula, read from the answer with
/// operands from left to right. The order of the tape does not matter.
///
/// `below`: considers only contributions smaller than this.
std::vector<NodeId> find_largest_contributions(const Tape& tape, const Attribution& attribution,
                                               std::optional<double> below = {});

/// Same as `find_largest_contributions`, but skips wrong choices that cancel each other, if there is any other error.
/// Such choices took another path to the same value and rounded nothing. (closest_approach does so on two rays in
/// five.)
std::vector<NodeId> find_culprit_and_equals(const Tape& tape, const Attribution& attribution);

/// True if the error of operation `from` goes through operation i.
bool is_computed_from(const Tape& tape, const Attribution& attribution, NodeId i, NodeId from);

}  // namespace lostbits::measure::attribution
