// One evaluation of a form as a program of another language: C that reproduces it to the bit, FPCore for Herbie and FPBench.
#pragma once

#include <string>

#include "measure/explanation.hpp"

namespace lostbits::output {

/// A C99 program without anything of ours: the inputs in hexadecimal, the form an operation a line, then computed and true value. It
/// exits 0 where its t has the bits that were recorded, 1 otherwise. Values are volatile, so that no compiler fuses or widens
/// them. Formats of at most 25 bits other than float compute in double and round, which is the same (2p + 2 ≤ 53: Figueroa 1995);
/// InputError for wider ones, and where such a format moves to a neighbour or fuses.
std::string explain_c(const Explanation& x);

/// FPCore 2.0 of t: the arguments are the inputs that it depends on, :pre keeps each within 2^-12 of this ray's, zeros and infinities as they are.
/// InputError for forms that move to neighbouring numbers, for which FPCore has no operation.
std::string explain_fpcore(const Explanation& x);

}  // namespace lostbits::output
