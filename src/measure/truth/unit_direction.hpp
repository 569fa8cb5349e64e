// Directions for the forms that assume unit length.
#pragma once

#include "geometry/vec.hpp"
#include "number/format.hpp"

namespace lostbits::measure::truth {

/// d/|d|, each component correctly rounded to the format. Zero and non-finite directions give NaN.
Vec<double> unit_direction(const Vec<double>& d, const FloatFormat& format);

}  // namespace lostbits::measure::truth
