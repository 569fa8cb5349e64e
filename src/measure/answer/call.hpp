// What a call on a tape gives without any rounding: the form that it is of, in enclosures.
#pragma once

#include <optional>
#include <span>

#include "number/ball.hpp"
#include "number/concept.hpp"
#include "number/real.hpp"

namespace lostbits::measure::answer {

/// Of arguments that are enclosed; nothing where that leaves the decision or the number open. A ball of 2^880 or more
/// is infinite, as the end of a ray may be.
std::optional<Ball> without_rounding(const Call& call, std::span<const Ball> arguments);
/// To 2048 bits.
std::optional<BasicReal<2048>> without_rounding(const Call& call, std::span<const BasicReal<2048>> arguments);

}  // namespace lostbits::measure::answer
