// Normalises directions for the forms that assume unit length.
#pragma once

#include <array>
#include <span>

#include "geometry/vec.hpp"
#include "number/format.hpp"

namespace lostbits::measure::truth {

/// d/|d|, each component correctly rounded to the format. Zero and non-finite directions give NaN.
Vec<double> unit_direction(const Vec<double>& d, const FloatFormat& format);

/// Normalises many directions in place, given as a column for each component.
void make_unit(const std::array<std::span<double>, 3>& directions, const FloatFormat& format);

/// Converts an end t of the range of a ray with direction d to a distance: t |d|, rounded once to the format.
double as_distance(double t, const Vec<double>& d, const FloatFormat& format);

}  // namespace lostbits::measure::truth
