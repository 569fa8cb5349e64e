// What the bounds that renderers rely on are bounds of, and what a form says of its own answer.
#pragma once

#include "measure/metric/metrics.hpp"
#include "shapes/hull.hpp"

namespace lostbits::measure::metric {

/// The largest component of P − P*, in (1 + max|P|) u.
double point_error(const Sample& s);
/// The largest relative error of a component of the hit point put back onto its sphere, in u; missing for boxes.
double projected_error(const Sample& s);
/// By how many u a far plane's t must grow for the slabs of a box that is truly hit to overlap; missing for
/// others. Behind a box it is that of the box, whatever the solid.
double padding(const Sample& s);
/// The same of the slabs of one box, in binary32, whether or not the ray hits it.
double padding(const Ray<float>& ray, const Hull<float>& box);

/// The form's own bound on the rounding error of t, in ulps of the format at t*; infinite where it knows nothing.
double bound(const Sample& s);
/// The bound over the size of an error in the same ulps; 1 where both are zero.
double bound_over(const Sample& s, double error);
/// The place in `intersect::decision_names`.
double decision(const Sample& s);
/// The place in `intersect::way_names`.
double arithmetic(const Sample& s);

}  // namespace lostbits::measure::metric
