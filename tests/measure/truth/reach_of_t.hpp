// How far errors of the inputs can move t, in units of t.
#pragma once

#include <cmath>

#include "measure/truth/reach.hpp"

namespace lostbits::test {

inline double reach_of_t(const Ray<double>& ray, const Solid<double>& solid, const measure::truth::Certified& t,
                         const FloatFormat& format,
                         measure::truth::Perturbed perturbed = measure::truth::Perturbed::componentwise) {
    const double reach = measure::truth::reach(ray, solid, t, measure::truth::Length::parameter, format, perturbed);
    return std::ldexp(reach, static_cast<int>(measure::truth::exponent_of_unit(t)));
}

}  // namespace lostbits::test
