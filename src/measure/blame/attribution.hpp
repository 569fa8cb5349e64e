// Which operation lost the bits: the error of an answer shared out among the operations of its tape.
//
// An operation is assigned its own rounding error times the adjoint of the recorded path (Linnainmaa 1976, here with
// difference quotients). That is a rule, not a cause: Herbgrind (2018) blames by local error instead, the values of
// Shapley and of Aumann and Shapley share out without one path, and what one operation does by itself is in rerun.hpp.
#pragma once

#include <optional>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// What is known of one node of a tape. `exact` is what it is without any rounding, every decision taken by exact
/// values.
///
/// An error goes on through v = f(x) by the difference quotient between the operands as computed (^) and exact (*):
/// ab: (b^ + b*)/2 and (a^ + a*)/2; a/b: (1/b^ + 1/b*)/2 and −(a^ + a*)/(2 b^ b*); √a: 1/(√a^ + √a*); and 1 through a
/// sum. To first order it is the derivative; unlike that it leaves no remainder, so that the contributions sum to the
/// error even where the derivative is infinite (the root of a discriminant that rounds to 0).
struct OperationError {
    double exact = 0;       ///< to the nearest double
    double error = 0;       ///< computed − exact
    double rounding = 0;    ///< its own: computed − the exact operation on the operands as computed; of a choice that
                            ///< rounding turned, exact values of the side taken − of the side left
    double adjoint = 0;     ///< difference quotient of the subject by this value
    double derivative = 0;  ///< ∂subject/∂value at the computed values; only where asked for
    double contribution = 0;  ///< rounding · adjoint, in the unit of the subject
    double local_bits =
        0;  ///< bits that it loses when rerun on exact operands, each correctly rounded; only where asked for
    int cancelled = 0;  ///< max(exponent of operands) − exponent of result, of a sum (or the sum in an fma); the whole
                        ///< significand where the result is 0
    bool carried = false;  ///< an operand carries error: a cancellation here is catastrophic, otherwise benign
    bool live = false;     ///< the subject is computed from it, on the chosen side of each select
    bool turned = false;   ///< a decision, or the choice of a min, max, select or sign, that differs from the exact one
};

struct Attribution {
    std::vector<OperationError> of;  ///< a node each
    NodeId subject = no_node;        ///< what is explained: t, or the comparison that turned the form's decision
    bool exact_hit = false;          ///< the form's decision without rounding
    bool cut_short =
        false;             ///< without rounding a loop would have gone on: exact values end where the computed ones did
    double error = 0;      ///< of the subject (of the difference of a comparison's sides)
    double explained = 0;  ///< sum of the contributions
    double first_order = 0;  ///< the same with derivatives; only where asked for
    int exact_bits = 0;      ///< precision of the exact values: 106 (double-double with bounds), or 2048
    /// The live operation with the largest |contribution|, and of equals the one that `largest_contributions` puts
    /// first: of two of which one is computed from the other, the later. Of a subject (or a side of it) that is no
    /// number, the operation that made it so. None where nothing was lost.
    NodeId culprit = no_node;
    /// The other live operations that contribute as much as the culprit, with the same sign or the opposite one.
    std::vector<NodeId> equals;

    [[nodiscard]] const OperationError& operator[](NodeId i) const { return of[static_cast<std::size_t>(i)]; }
};

struct AttributionDepth {
    /// For each operation its derivative and its local error, all with exact values of 2048 bits.
    bool full = false;
};

/// Of a subject that is a number: its error. Of a decision: of the first comparison behind it that rounding turned,
/// whose sides' difference is the subject; none where no comparison turned.
///
/// Exact values are double-double with certified bounds where those settle every decision and hold each live value to
/// 2^-60 of the larger of it and the computed one; otherwise 2048 bits, where values nearer to each other than 2^-1900
/// of themselves are equal.
Attribution attribute(const Tape& tape, NodeId subject, AttributionDepth depth = {});

/// What to ask of a tape: its t where the form's decision is the exact one, otherwise the decision. The t of a miss is
/// no answer, so no operation is the culprit of it.
Attribution attribute(const Tape& tape, AttributionDepth depth = {});

/// Whether the form misses, and would without rounding.
bool is_plain_miss(const Tape& tape, const Attribution& found);

/// Contributions are equal where their sizes agree to this part of the larger. They are sums of products in binary64,
/// far better than this; but two that are equal to first order differ by the relative error of what lies between them,
/// which from binary32 up is mostly less than this. Of 2.9 million rays of the scenes 11 % have equals, and on one in
/// eight of those the equals differ by more than 2^-40.
inline constexpr double equal_contributions = 0x1p-20;

/// The live operations of the largest |contribution|, the culprit first; none where nothing was lost. Those nearer to
/// the subject come first (by the most operations in between, so that what is computed from another comes before it),
/// and of equally near ones that which comes first when the formula is read from the answer, operands from left to
/// right. The order of the tape does not matter.
///
/// `below`: only those smaller than that are asked.
std::vector<NodeId> largest_contributions(const Tape& tape, const Attribution& found, std::optional<double> below = {});

/// The same, but wrong choices that undo each other are passed over while anything else was lost: they took another way
/// to the same value, and rounded nothing. (closest_approach does so on two rays in five.)
std::vector<NodeId> culprit_and_equals(const Tape& tape, const Attribution& found);

/// Whether the error of operation `from` goes through operation i.
bool is_computed_from(const Tape& tape, const Attribution& found, NodeId i, NodeId from);

}  // namespace lostbits::measure::blame
