// A filter by the span of the torus: the quartic of the closest approach, whose first root ahead the signs of Sturm's
// chain isolate.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/torus/torus.hpp"

namespace lostbits::intersect::torus {

struct FilteredTorus : filter::SpanFilter<FilteredTorus, Torus> {
    static constexpr Info info{
        .name = "torus.filtered",
        .title = "Sturm's chain if a bound proves it, else wider arithmetic",
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::torus
