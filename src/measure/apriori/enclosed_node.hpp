// What is known of one node of a tape over a box of inputs, with rounding and without.
#pragma once

#include <array>

#include "number/format.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"
#include "number/tri.hpp"

namespace lostbits::measure::apriori {

/// A number and what a decision says, each over every input of a box: `exact` without rounding, `computed` as the
/// format has it. Of a number, for each input,
///     computed − exact = Σ quotients[k] (computed − exact of operand k) + own.
struct EnclosedNode {
    bool known = false;  ///< of a number; nothing is where an operation may be undefined, or overflow
    Interval exact = {}, computed = {}, own = {};
    std::array<Interval, 3> quotients = {};
    bool jumps = false;  ///< `own` is of a side or a sign that may be chosen apart, too
    Tri exact_decision = Tri::unknown, computed_decision = Tri::unknown;
};

/// The operands of a node and the formats of its result and of its first operand.
struct Enclosing {
    const TapeNode& node;
    std::array<const EnclosedNode*, 3> operands;
    FloatFormat format, from;
};

/// A node that is not an input.
EnclosedNode enclose(const Enclosing& of);

/// An input. An end at infinity is put beyond every number of a format.
EnclosedNode enclose_input(double low, double high);

/// Whether it is nothing but zero.
bool is_zero(const Interval& x);

/// The largest size in an enclosure, and the least, rounded outward to a double.
double most_of(const Interval& x);
double least_of(const Interval& x);

}  // namespace lostbits::measure::apriori
