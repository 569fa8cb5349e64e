// A filter by the span of the tube: the t at which the line crosses the near and the far side of the wall.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::intersect::tube {

struct FilteredTube : filter::SpanFilter<FilteredTube, Tube> {
    static constexpr Info info{
        .name = "tube.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::tube
