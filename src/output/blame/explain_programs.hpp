// One evaluation of a form as a program of another language: C that reproduces it to the bit, FPCore for Herbie and
// FPBench.
#pragma once

#include <string>

#include "measure/blame/explanation.hpp"

namespace lostbits::output::blame {

/// A C99 program without anything of ours: the inputs in hexadecimal, the form an operation a line, then the computed,
/// the true and the recorded t, the first and the last of which are the same text where they are the same bits. It
/// exits 0 then, 1 otherwise. Values are volatile, so that no compiler fuses or widens them.
///
/// Formats other than float and double compute in double and round: of at most 25 bits the double alone (2p + 2 ≤ 53:
/// Figueroa 1995), wider ones the double with the sign of what it leaves out (TwoSum; fma for products, quotients and
/// roots). InputError where such a format moves to a neighbour or fuses, and where a wider one comes so near to the
/// ends of double's range that what is left out has no double.
std::string explain_c(const measure::blame::Explanation& x);

/// FPCore 2.0 of t: the arguments are the inputs that it depends on, :pre keeps each within 2^-12 of this ray's, zeros
/// and infinities as they are. A move to a neighbouring number is a sum with the smallest number, rounded upward or
/// downward (`:round`).
std::string explain_fpcore(const measure::blame::Explanation& x);

}  // namespace lostbits::output::blame
