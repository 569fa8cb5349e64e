// Real: the value of a formula with practically no rounding. It is MPFR through Boost.Multiprecision. Values are on the
// stack, and expression templates are off because they reorder operations.
#pragma once

#include <boost/multiprecision/mpfr.hpp>

#include "number/concept.hpp"

namespace lostbits {

/// An MPFR number of at least `Bits` bits.
template <unsigned Bits>
using BasicReal = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<Bits * 301 / 1000 + 1, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

using Real = BasicReal<256>;

template <unsigned Digits>
inline constexpr bool is_exact<boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<Digits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>> = true;

static_assert(Number<Real>);

}  // namespace lostbits
