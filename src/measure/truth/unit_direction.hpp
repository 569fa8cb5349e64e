// Directions for the forms that assume unit length.
#pragma once

#include <array>
#include <span>

#include "geometry/vec.hpp"
#include "number/format.hpp"

namespace lostbits::measure::truth {

/// d/|d|, each component correctly rounded to the format. Zero and non-finite directions give NaN.
Vec<double> unit_direction(const Vec<double>& d, const FloatFormat& format);

/// Makes many directions unit at once, as columns, in place.
void make_unit(const std::array<std::span<double>, 3>& directions, const FloatFormat& format);

/// t |d|, rounded once to the format: the end of a range, for the direction of length one.
double as_distance(double t, const Vec<double>& d, const FloatFormat& format);

}  // namespace lostbits::measure::truth
