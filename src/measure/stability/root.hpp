// Whether a wrong t is that of another crossing of the same solid.
#pragma once

#include "measure/truth/truth.hpp"

namespace lostbits::measure::stability {

/// Whether t is another place where the ray's line, ahead or behind, crosses the surface that it truly meets at
/// `truth`: whether it is nearer to that than a quarter of what lies between the two. The three crossings behind the
/// true one are looked at, and the three nearest behind the origin.
bool is_wrong_root(const Ray<double>& ray, const Solid<double>& solid, const truth::Certified& truth, double t);

}  // namespace lostbits::measure::stability
