// Fractions, in which tests compute exact answers.
#pragma once

#include <array>

#include <boost/multiprecision/gmp.hpp>

#include "geometry/vec.hpp"

namespace lostbits::test {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

using lostbits::dot;  // of vectors, which that of fractions would hide
inline Rational dot(const std::array<Rational, 3>& u, const std::array<Rational, 3>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

}  // namespace lostbits::test
