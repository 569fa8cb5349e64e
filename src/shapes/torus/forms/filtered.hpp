// The quartic of the closest approach, its first root ahead told by the signs of Sturm's chain, with a bound on the
// rounding of every step; where that does not prove the decision, or leaves t less than 17 correct bits of 24 (46 of
// 53), the ray is done again in wider arithmetic: float, double, double-double, intervals. No wrong decision about the
// closed torus. The first intersection: near = far = t.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/torus/torus.hpp"

namespace lostbits::intersect::torus {

struct FilteredTorus : filter::FiltersBySpan<FilteredTorus, Torus> {
    static constexpr Info info{
        .name = "torus.filtered",
        .title = "Sturm's chain where a bound proves it, wider where not",
        .source = "a running bound after Higham, Accuracy and Stability, 3.3, as a filter after Shewchuk 1997",
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::torus
