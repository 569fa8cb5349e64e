// A filter by the span of the cone: the interval in which the line is inside the side and the caps.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/cone/cone.hpp"

namespace lostbits::intersect::cone {

struct FilteredCone : filter::SpanFilter<FilteredCone, Cone> {
    static constexpr Info info{
        .name = "cone.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::cone
