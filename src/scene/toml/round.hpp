// From the ideal numbers of a scene to the numbers of a format: one correct rounding each, never two.
#pragma once

#include "number/format.hpp"
#include "number/real.hpp"

namespace lostbits::scene::toml {

/// RN_F(x): x rounded once to nearest, ties to even, in format F, held in a double (every number of a format is
/// one). Subnormals are F's own; magnitudes of (2 − 2^−p)·2^emax and above become infinite; a zero keeps x's sign.
double round_to_format(const Real& x, const FloatFormat& f);

/// x to 12 significant bits: a few such numbers have exact products and sums in binary32.
double to_12_bits(double x);

}  // namespace lostbits::scene::toml
