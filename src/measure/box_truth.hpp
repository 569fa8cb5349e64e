// Truth of a ray and a box: where the ray enters it, and a proof.
#pragma once

#include "geometry/shapes.hpp"
#include "intersect/info.hpp"
#include "measure/truth.hpp"

namespace lostbits {

/// The problem of `enclose(ray, box, …)`, proved by enclosures of rising precision. `tmax` may be infinite and must not be NaN;
/// the ray's and the box's numbers must be finite, the direction not zero, and lo ≤ hi.
Truth find_truth(const Ray<double>& ray, const Box<double>& box, double tmax, Touching convention, TruthLimit limit = {});

/// t* correctly rounded to a format, ties decided exactly. For a hit only.
double round_truth(const Truth& truth, const Ray<double>& ray, const Box<double>& box, const FloatFormat& format);

}  // namespace lostbits
