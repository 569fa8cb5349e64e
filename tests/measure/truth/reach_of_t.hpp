// Reach of t under errors of the inputs, in units of t. A subnormal reach is rounded up.
#pragma once

#include <cmath>
#include <limits>

#include "measure/truth/reach.hpp"

namespace lostbits::test {

inline double reach_of_t(const Ray<double>& ray, const Primitive<double>& primitive,
                         const measure::truth::CertifiedNumber& t, const FloatFormat& format,
                         measure::truth::Perturbation perturbation = measure::truth::Perturbation::componentwise) {
    const double reach =
        measure::truth::reach(ray, primitive, t, measure::truth::Length::parameter, format, perturbation);
    const double in_t = std::ldexp(reach, static_cast<int>(measure::truth::exponent_of_unit(t)));
    return reach > 0 && in_t < 0x1p-980 ? in_t + std::numeric_limits<double>::denorm_min() : in_t;
}

}  // namespace lostbits::test
