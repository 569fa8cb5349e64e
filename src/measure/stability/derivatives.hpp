// What a differentiable renderer gets of t: its derivatives, as a form yields them in its format.
#pragma once

#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::stability {

/// ∂t/∂x of each input x of a tape, in their order, by forward differentiation: the chain rule for each operation, with
/// the tape's values, each of its own operations rounded to the format of that operation (as `Dual` of that format has
/// it). NaN where t is computed by a call, whose rule is not on the tape.
std::vector<double> forward_derivatives(const Tape& tape);

}  // namespace lostbits::measure::stability
