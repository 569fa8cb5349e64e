// Rounds the ideal numbers of a scene to a format, each by one correct rounding, never by two.
#pragma once

#include "number/format.hpp"
#include "number/real.hpp"

namespace lostbits::scene::toml {

/// RN_F(x): x rounded once to nearest, ties to even, in format F, and returned as a double, which holds every number
/// of a format. Subnormals are those of F. Magnitudes of (2 − 2^−p)·2^emax and above become infinite. A zero keeps x's
/// sign.
double round_to_format(const Real& x, const FloatFormat& format);

/// Rounds x to 12 significant bits. Products and sums of a few such numbers are exact in binary32.
double round_to_12_bits(double x);

}  // namespace lostbits::scene::toml
