// A filter by the span of the cylinder: the interval in which the line is inside the side and the caps.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits::intersect::cylinder {

struct FilteredCylinder : filter::SpanFilter<FilteredCylinder, Cylinder> {
    static constexpr Info info{
        .name = "cylinder.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::cylinder
