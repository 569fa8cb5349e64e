// Enclosures of one node of a tape over a box of inputs, with and without rounding.
#pragma once

#include <array>

#include "number/format.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"
#include "number/tri.hpp"

namespace lostbits::measure::apriori {

/// Enclosures of a number, or the outcome of a decision, over every input of a box: `exact` without rounding,
/// `computed` as the format rounds it. For a number and each input:
///
///   computed − exact = Σ quotients[k] (computed − exact of operand k) + rounding.
struct EnclosedNode {
    bool is_known = false;  ///< true for a number if no operation can be undefined or overflow
    Interval exact = {}, computed = {}, rounding = {};
    std::array<Interval, 3> quotients = {};
    /// True if `rounding` includes a choice or a sign that may differ with and without rounding.
    bool may_jump = false;
    Tri exact_decision = Tri::unknown, computed_decision = Tri::unknown;
};

/// A node, its operands, and the formats of its result and of its first operand.
struct NodeContext {
    const TapeNode& node;
    std::array<const EnclosedNode*, 3> operands;
    FloatFormat format, operand_format;
};

/// Encloses a node that is not an input.
EnclosedNode enclose(const NodeContext& context);

/// Encloses an input. An end at infinity is replaced by a number larger than every number of a format.
EnclosedNode enclose_input(double low, double high);

/// True if the interval contains only zero.
bool is_zero(const Interval& x);

/// Largest and least magnitude in an enclosure, rounded outward to double.
double upper_magnitude(const Interval& x);
double lower_magnitude(const Interval& x);

}  // namespace lostbits::measure::apriori
