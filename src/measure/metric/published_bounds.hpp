// What the bounds that renderers rely on are bounds of.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// The largest component of P − P*, in (1 + max|P|) u.
double point_error(const Sample& s);
/// The largest relative error of a component of the hit point put back onto its sphere, in u; missing for boxes.
double projected_error(const Sample& s);
/// By how many u a far plane's t must grow for the slabs of a box that is truly hit to overlap; missing for
/// others. Behind a box it is that of the box, whatever the solid.
double padding(const Sample& s);

}  // namespace lostbits::measure::metric
