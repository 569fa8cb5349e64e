// What is known of each operation of a tape, one struct an operation. Its name, its kind and the number of its operands
// are its row in number/tape.hpp; what its struct holds follows from the kind (below), and without it nothing compiles.
//
//   given       exact(node) and rounding(node)
//   rounded     exact(a, …) without rounding; computed(a, …, format); residual(a, …, value): value − exact where
//   doubles
//               can hold it; addends(a, …): what cancels; quotients(a, …)
//   called      nothing: what it gives without rounding is in answer/self.hpp
//   exact       exact(a), computed(a, format), quotients(a)
//   moved       computed(a, format)
//   sign        computed(a, b, format), quotients(a, b)
//   choice      sides: the places of the two operands; takes_first(judge)
//   comparison  holds(judge)
//   logic       holds(judge)
//   all         text
//
// A judge answers less(i, j), less_equal(i, j) and holds(i) for the operands at those places, by their computed or by
// their exact values.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "measure/blame/operation_text.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// From the exact value of an operand to the computed one. Of a derivative both are the computed one.
struct Step {
    double from = 0, to = 0;
    bool is_derivative = false;

    [[nodiscard]] double middle() const { return from / 2 + to / 2; }
    /// (|to| − |from|)/(to − from)
    [[nodiscard]] double of_size() const {
        if (std::signbit(to) == std::signbit(from)) return std::signbit(to) ? -1 : 1;
        return (std::fabs(to) - std::fabs(from)) / (to - from);
    }
};

/// By how much each operand's error is multiplied on the way through; none for decisions, for sides not taken, and for
/// the operand of copysign that gives its sign.
using Quotients = std::array<std::optional<double>, 3>;

/// One struct for each row of LOSTBITS_TAPE_OPERATIONS: operations_of_numbers.hpp and operations_that_decide.hpp.
template <TapeOp op>
struct Operation;

}  // namespace lostbits::measure::blame
