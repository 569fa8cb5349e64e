// Fractions, in which tests answer what forms are asked.
#pragma once

#include <boost/multiprecision/gmp.hpp>

namespace lostbits::test {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

}  // namespace lostbits::test
