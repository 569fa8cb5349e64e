// Where the line is inside, the near and the far side of the wall: a filter by its span.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::intersect::tube {

struct FilteredTube : filter::FiltersBySpan<FilteredTube, Tube> {
    static constexpr Info info{
        .name = "tube.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::tube
