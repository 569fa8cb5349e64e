// A solid under a matrix, directly.
#pragma once

#include <optional>

#include "shapes/solid.hpp"

namespace lostbits::measure::consistency {

/// The solid whose numbers say where one under a stored matrix stands, each rounded once to the format. Nothing where
/// there is none: a shape with lengths or directions under a matrix that is no turn and common scale to within 4u, a
/// box under one that is not diagonal, radii by axis; and of a stored inverse.
std::optional<Solid<double>> image_of(const Solid<double>& solid, const FloatFormat& format);

}  // namespace lostbits::measure::consistency
